"""Which way is free: the heading nearest to the wanted one along which the robot's body meets nothing."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...envs.task.interface import FollowInterface

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class AvoidanceConfig:
    """How the robot keeps clear of things.

    Attributes:
        front: Space kept free in front [m].
        margin: Space kept free on each side [m].
        turning: Gap that no corner of the robot's box may come below by a turn, a few times the laser's noise [m].
        horizon: How far ahead things are looked at [m].
        widest: Largest deviation from the wanted heading [rad].
        candidates: Number of headings compared, odd.
        blocked_cost: What a heading that is blocked at once costs, against one radian of deviation [rad].
        change_cost: What a radian of change of the chosen deviation since the last step costs [rad].
    """

    front: float = 0.145
    margin: float = 0.121
    turning: float = 0.04
    horizon: float = 1.5
    widest: float = 1.2
    candidates: int = 25
    blocked_cost: float = 2.0
    change_cost: float = 0.25


@dataclass(frozen=True)
class FreeHeading:
    """Where to go.

    Attributes:
        heading: In the robot frame [rad].
        ahead: Free length in front of the robot's edge along its present heading [m], at most the horizon.
    """

    heading: float
    ahead: float


def free_heading(
    wanted: float,
    reach: float,
    obstacles: Array,
    last_deviation: float,
    config: AvoidanceConfig,
    robot: FollowInterface,
) -> FreeHeading:
    """Return the cheapest heading near `wanted`.

    Args:
        wanted: Heading to the goal in the robot frame [rad].
        reach: Distance to the goal; things beyond it do not matter [m].
        obstacles: (n, 2) points in the robot frame [m].
        last_deviation: Deviation from the wanted heading that was chosen the last time [rad].
        config: Spaces and costs.
        robot: Its size.
    """
    deviations = np.linspace(-config.widest, config.widest, config.candidates)
    headings = np.append(wanted + deviations, 0.0)
    free = free_lengths(headings, obstacles, config, robot)
    wish = min(max(reach, 0.1), config.horizon)
    blocked = 1.0 - np.minimum(free[:-1], wish) / wish
    cost = np.abs(deviations) + config.blocked_cost * blocked + config.change_cost * np.abs(deviations - last_deviation)
    return FreeHeading(float(headings[np.argmin(cost)]), float(free[-1]))


def free_turns(obstacles: Array, config: AvoidanceConfig, robot: FollowInterface) -> tuple[float, float]:
    """Return how far the robot can turn on the spot to the left, and to the right, before its box meets one of
    `obstacles` (n, 2), robot frame [m]; at most half a turn [rad].

    Seen from the robot an obstacle goes round in a circle, and of that circle the box, grown by the gap that is kept,
    leaves four arcs free: before it, behind it and at its sides. What is nearer than the gap may not come nearer.
    """
    x, y = obstacles[:, 0], obstacles[:, 1]
    gaps = np.maximum(np.abs(x) - robot.half_length, np.abs(y) - robot.half_width)
    kept = np.minimum(gaps, config.turning)
    length, width, radius = robot.half_length + kept, robot.half_width + kept, np.hypot(x, y)
    meets = (gaps > 0.0) & (radius < np.hypot(length, width))
    x, y, length, width, radius = x[meets], y[meets], length[meets], width[meets], radius[meets]
    ends = np.abs(x) >= length  # before the box or behind it, not at its sides
    half_arc = np.where(ends, np.arccos(np.minimum(length / radius, 1.0)), np.arccos(np.minimum(width / radius, 1.0)))
    from_middle = np.where(ends, np.arctan2(y * np.sign(x), np.abs(x)), np.arctan2(-x * np.sign(y), np.abs(y)))
    left, right = half_arc + from_middle, half_arc - from_middle
    return float(left.min(initial=np.pi)), float(right.min(initial=np.pi))


def kept_turn(
    wish: float,
    obstacles: Array,
    acceleration: float,
    reaction_s: float,
    config: AvoidanceConfig,
    robot: FollowInterface,
) -> float:
    """Return the turn rate nearest to `wish` [rad/s] that ends before the robot's box meets one of `obstacles` (n, 2)
    [m], with that `acceleration` [rad/s^2] after a time of reaction [s]."""
    left, right = (stopping_speed(room, acceleration, reaction_s) for room in free_turns(obstacles, config, robot))
    return min(max(wish, -right), left)


def stopping_speed(room: float, braking: float, reaction_s: float) -> float:
    """Return the speed from which one stops within `room`, after a time of reaction [s]; of a turn likewise."""
    lag = braking * reaction_s
    return math.sqrt(lag**2 + 2.0 * braking * max(0.0, room)) - lag


def free_lengths(headings: Array, obstacles: Array, config: AvoidanceConfig, robot: FollowInterface) -> Array:
    """Return (k,) free length [m] in front of the robot's edge along each of `headings` (k,), up to the horizon."""
    front = round(robot.half_length + config.front, 6)  # what its decimals say, not what their binary sum does
    half_width = robot.half_width
    near = obstacles[np.abs(obstacles).max(axis=1, initial=0.0) < config.horizon + front + half_width]
    cos, sin = np.cos(headings)[:, None], np.sin(headings)[:, None]
    along = cos * near[:, 0] + sin * near[:, 1]
    across = np.abs(cos * near[:, 1] - sin * near[:, 0])
    meets = (along > 0.0) & (across < half_width + config.margin)
    free = np.where(meets, along - front, config.horizon).min(axis=1, initial=config.horizon)
    return np.maximum(free, 0.0)
