"""A guard on the way from wish to wheels: what could not be stopped in time, and would touch something, is not driven.

From the commands of a wish the robot must be able to brake without touching any return of the laser. If it is not, the
nearest wish is taken from which it can. The guard interferes at the last moment only, so what is smooth stays smooth;
learning is left to find good ways, and is spared the last centimetres (Wagener, Boots, Cheng 2021). Who touches
something already may leave it, but not press on; and nobody backs over ground that was never seen (`GroundBehind`).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...envs.task.interface import FollowInterface
from ...slam.errors import InputError
from ..protocol.follower import Observation
from ..scripted.ground_behind import GroundBehind
from ..scripted.scan_points import ScanPoints, own_velocity, without
from .braking import (
    MOST_WISHES,
    NEARER_M,
    GuardNumbers,
    brakes_in_time,
    goes_wide,
    put_alternatives,
    put_bounds,
    put_velocities,
    stopping,
)
from .situation import Wish
from .steering import State, SteeringConfig

Array = NDArray[np.float64]

_MOST_STEPS = 100
"""Of braking: a robot that does not stand after 10 s has no brakes."""
_MOST_S = 10.0
"""For which returns are remembered: more of them than of 100 scans cannot be looked at in a step."""


@dataclass(frozen=True, kw_only=True)
class GuardConfig:
    """What is guarded.

    Attributes:
        margin: Gap kept to every return, a few times the laser's noise; who is nearer may not come nearer [m].
        reach: Returns farther than this from the laser do not matter [m].
        stride: Returns this far before and behind where somebody is believed to be, and half as far to the sides, are
            that person's legs, and walk on [m].
        brake_steps: Steps that braking is followed, at most.
        remembered_s: For how long returns are remembered that the laser, looking forward, has lost behind it [s].
    """

    margin: float = 0.04
    reach: float = 1.4
    stride: float = 0.45
    brake_steps: int = 16
    remembered_s: float = 3.0

    def __post_init__(self) -> None:
        if not (self.margin >= 0.0 and self.reach > 0.0 and 1 <= self.brake_steps <= _MOST_STEPS):
            raise InputError(f"a guard needs margin >= 0, reach > 0 and 1 to {_MOST_STEPS} steps of braking")
        if not 0.0 <= self.remembered_s <= _MOST_S:
            raise InputError(f"a guard remembers for 0 to {_MOST_S:g} s, got {self.remembered_s}")

    def of(self, robot: FollowInterface) -> GuardNumbers:
        """Return its numbers and those of a robot, as kernels take them."""
        x, y, _ = robot.T_robot_lidar
        return GuardNumbers(
            float(robot.half_length), float(robot.half_width), float(x), float(y), float(robot.range_max),
            1.0 / robot.control_hz, float(self.margin), float(self.reach), float(self.stride), int(self.brake_steps),
        )  # fmt: skip


_NOTHING = np.zeros((0, 5))
_BEHIND_M = 0.8
"""Farther off, what the laser has lost behind the robot is no longer minded."""


class Guard:
    """Watches one episode.

    Args:
        config: What is guarded.
        steering: How wishes are driven.
        interface: Scales of the environment.
    """

    def __init__(self, config: GuardConfig, steering: SteeringConfig, interface: FollowInterface) -> None:
        self.config, self._robot = config, interface
        self._steering, self._numbers = np.array(steering.as_tuple()), config.of(interface)
        self._step_s = 1.0 / interface.control_hz
        self._scan = ScanPoints(interface)
        self._laser = np.array(interface.T_robot_lidar[:2])
        self._behind = GroundBehind(interface)
        self.reset()

    def reset(self) -> None:
        """Forget everything."""
        self._points = np.zeros((0, 2))
        self._lost = np.zeros((0, 3))  # x, y [m], age [s]
        self._leader, self._people = np.zeros(6), np.zeros((0, 6))
        self._behind.reset()

    def observe(self, observation: Observation) -> None:
        """Take the returns of an observation; once a step, before `limit`."""
        self._behind.observe(observation)
        dx, dy, turned = (value * self._step_s for value in own_velocity(observation))
        old = np.vstack((self._lost, np.column_stack((self._points, np.zeros(len(self._points))))))
        x, y = old[:, 0] - dx, old[:, 1] - dy
        cos, sin = np.cos(turned), np.sin(turned)
        moved = np.column_stack((cos * x + sin * y, cos * y - sin * x, old[:, 2] + self._step_s))
        bearing = np.arctan2(moved[:, 1] - self._laser[1], moved[:, 0] - self._laser[0])
        unseen = self._robot.along_scan(bearing) > 1.0
        near = np.hypot(moved[:, 0], moved[:, 1]) < _BEHIND_M
        self._lost = moved[unseen & near & (moved[:, 2] < self.config.remembered_s)]
        self._points = self._scan.near(observation, self.config.reach)
        self._leader, self._people = (observation[name].astype(np.float64) for name in ("leader", "people"))

    @property
    def things(self) -> Array:
        """(n, 2) what is near but for the leader, robot frame [m]; not to be written to."""
        there = self._leader[None, :2] if self._leader[5] >= 0.5 else np.zeros((0, 2))
        return np.vstack((without(self._points, there, self.config.stride), self._lost[:, :2]))

    def room_behind(self) -> float:
        """Return how far back the ground is known to be free, at most 1 m [m]."""
        return self._behind.room()

    def limit(self, state: State, wish: Wish) -> Wish:
        """Return `wish`, or the nearest one that can be braked without a touch; the quickest stop if there is none.

        Args:
            state: What is commanded now.
            wish: Speed [m/s] and turn rate [rad/s].
        """
        near, now = np.zeros((len(self._points) + len(self._lost), 5)), np.array(state)
        near[:, :2] = np.vstack((self._points, self._lost[:, :2]))
        near[:, 2] = signed_gaps(np.zeros((1, 3)), near[:, :2], self._robot)[0]
        least = float(near[:, 2].min(initial=np.inf))
        if goes_wide(least, state[0]) and min(wish[0], state[0]) >= 0.0:
            return wish
        put_bounds(near, least, self.config.margin)
        put_velocities(near[: len(self._points)], self._leader, self._people, self.config.stride)
        if self._passes(now, wish, near):
            return wish
        tried = np.empty((MOST_WISHES, 3))
        put_alternatives(*wish, tried)
        for speed, turn, _ in tried.tolist():
            if self._passes(now, (speed, turn), near):
                return speed, turn
        return stopping(state[0], self._step_s, self._steering), 0.0

    def _passes(self, state: Array, wish: Wish, near: Array) -> bool:
        """Return whether one step of a wish, and braking then, keeps gaps and the room behind.

        Args:
            state: (4,) what is commanded now.
            wish: Speed [m/s] and turn rate [rad/s].
            near: (m, 5) what must not be touched, see `brakes_in_time`.
        """
        keeps, back = brakes_in_time(state, *wish, near, self._steering, self._numbers)
        if not keeps or back <= NEARER_M:
            return keeps
        anyhow = brakes_in_time(state, 0.0, 0.0, _NOTHING, self._steering, self._numbers)[1]
        return back <= anyhow + NEARER_M or back <= self.room_behind()


def driven(poses: Array, states: Array, step_s: float) -> Array:
    """Return (n, 3) where `poses` (n, 3) are after `step_s` [s] at the commands `states` (n, 4)."""
    middle, way = poses[:, 2] + 0.5 * states[:, 2] * step_s, states[:, 0] * step_s
    return poses + np.column_stack((way * np.cos(middle), way * np.sin(middle), states[:, 2] * step_s))


def signed_gaps(poses: Array, things: Array, robot: FollowInterface) -> Array:
    """Return (n, m) distance from the robot's box at each of `poses` (n, 3) to each of `things` (m, 2) [m].

    Of a thing inside the box it is negative: how deep inside, to the nearest side.
    """
    ahead, aside = _beyond(poses, things, robot)
    outside = np.sqrt(np.maximum(ahead, 0.0) ** 2 + np.maximum(aside, 0.0) ** 2)
    return outside + np.minimum(np.maximum(ahead, aside), 0.0)


def box_gaps(poses: Array, things: Array, robot: FollowInterface) -> Array:
    """Return (n,) the least of `signed_gaps` at each of `poses` (n, 3) [m]; without things, infinity."""
    ahead, aside = _beyond(poses, things, robot)
    square = np.maximum(ahead, 0.0) ** 2 + np.maximum(aside, 0.0) ** 2
    least = np.sqrt(square.min(axis=1, initial=np.inf))
    touched = least == 0.0
    least[touched] = np.minimum(np.maximum(ahead[touched], aside[touched]).min(axis=1, initial=np.inf), 0.0)
    return least


def _beyond(poses: Array, things: Array, robot: FollowInterface) -> tuple[Array, Array]:
    """Return (n, m) how far each thing is beyond the front or the rear, and beyond the sides; negative: within [m]."""
    x, y = things[:, 0] - poses[:, :1], things[:, 1] - poses[:, 1:2]
    cos, sin = np.cos(poses[:, 2:]), np.sin(poses[:, 2:])
    return np.abs(cos * x + sin * y) - robot.half_length, np.abs(cos * y - sin * x) - robot.half_width


class NoGuard:
    """Lets every wish pass."""

    def reset(self) -> None:
        """Forget nothing."""

    things = np.zeros((0, 2))
    """Nothing is minded."""

    def observe(self, observation: Observation) -> None:
        """Ignore the observation."""

    def limit(self, state: State, wish: Wish) -> Wish:
        """Return `wish`."""
        return wish

    def room_behind(self) -> float:
        """Mind no room."""
        return float("inf")
