"""What the laser of an observation met, as points around the robot."""

import numpy as np
from numpy.typing import NDArray

from ...envs.task.interface import FollowInterface
from ...slam.errors import InputError
from ..protocol.follower import Observation

Array = NDArray[np.float64]

MOST_BEAMS = 360
"""Of a finer scan, only so many beams are looked at."""


class ScanPoints:
    """Turns observation `scan` into points.

    Args:
        interface: Directions and scale of the beams, and where the laser sits.
    """

    def __init__(self, interface: FollowInterface) -> None:
        self._interface = interface
        stride = max(1, len(interface.bearings) // MOST_BEAMS)
        self._beams = slice(None, None, stride)
        x, y, turn = interface.T_robot_lidar
        bearings = interface.bearings[self._beams] + turn
        self._origin = np.array((x, y))
        self._directions = np.stack((np.cos(bearings), np.sin(bearings)), axis=1)

    def near(self, observation: Observation, within: float) -> Array:
        """Return (n, 2) returns in the robot frame that lie nearer to the laser than `within` [m]."""
        scan = scan_of(observation, len(self._interface.bearings))[self._beams]
        ranges = scan.astype(np.float64) * self._interface.range_max
        near = (ranges < within) & (scan < 1.0)
        return self._origin + ranges[near, None] * self._directions[near]


def scan_of(observation: Observation, beams: int) -> NDArray[np.float32]:
    """Return observation `scan`.

    Raises:
        InputError: If it has not as many beams as the follower was told.
    """
    scan = observation["scan"]
    if len(scan) != beams:
        raise InputError(
            f"the scan has {len(scan)} beams, this follower was made for {beams}: make it with the interface of its "
            "environment, `env.unwrapped.interface`"
        )
    return scan


def without(points: Array, places: Array, radius: float) -> Array:
    """Return the `points` (n, 2) that are farther than `radius` [m] from each of `places` (k, 2)."""
    if not len(places) or not len(points):
        return points
    gap = np.hypot(*(points[:, None] - places[None]).transpose(2, 0, 1)).min(axis=1)
    return points[gap > radius]


def own_velocity(observation: Observation) -> tuple[float, float, float]:
    """Return the robot's own (forward, left, turn) of an observation [m/s, m/s, rad/s]."""
    own = [float(v) for v in observation["velocity"]]
    return own[0], own[1] if len(own) == 3 else 0.0, own[-1]


def leader_row(observation: Observation) -> list[float]:
    """Return (6,) the leader of an observation, columns `LEADER_COLUMNS`.

    Raises:
        InputError: If nobody leads in the environment.
    """
    if "leader" not in observation:
        raise InputError("this follower needs a leader, the environment has none (`leader=False`)")
    return [float(v) for v in observation["leader"]]


def as_action(speed: float, turn: float, interface: FollowInterface) -> NDArray[np.float32]:
    """Return the action for a forward speed [m/s] and a turn rate [rad/s]: (2,), or (3,) for a holonomic robot."""
    forward = min(max(speed / interface.max_speed, -1.0), 1.0)
    turning = min(max(turn / interface.max_turn_rate, -1.0), 1.0)
    return np.array([forward, 0.0, turning] if interface.holonomic else [forward, turning], dtype=np.float32)
