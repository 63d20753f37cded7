"""Which way is free: the heading nearest to the wanted one along which the robot's body meets nothing."""

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
        horizon: How far ahead things are looked at [m].
        widest: Largest deviation from the wanted heading [rad].
        candidates: Number of headings compared, odd.
        blocked_cost: What a heading that is blocked at once costs, against one radian of deviation [rad].
        change_cost: What a radian of change of the chosen deviation since the last step costs [rad].
    """

    front: float = 0.145
    margin: float = 0.121
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
