"""What stands where in an observation and an action: all that a follower has to know about its environment."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...slam.occupancy_map import OccupancyMap

LEADER_COLUMNS = ("x", "y", "vx", "vy", "confidence", "visible")
"""Entries of observation `leader` [m, m, m/s, m/s, -, -], in the robot frame; velocities over ground."""
PERSON_COLUMNS = ("x", "y", "vx", "vy", "confidence", "present")
"""Columns of observation `people`, as those of `leader`; rows of people who are not there are zero."""


def _default_bearings() -> NDArray[np.float64]:
    return np.deg2rad(np.linspace(-135.0, 135.0, 1081))


@dataclass(frozen=True, eq=False)
class OwnMap:
    """What the robot itself knows of the building and of its place in it: the work of its SLAM, not the truth.

    Attributes:
        map: The map so far, without people; not to be written to.
        pose: (3,) T_map_robot.
    """

    map: OccupancyMap
    pose: NDArray[np.float64]


@dataclass(frozen=True, kw_only=True, eq=False)
class FollowInterface:
    """Scales of an environment's observations and actions.

    Attributes:
        max_speed: Forward speed at action +1 [m/s].
        max_turn_rate: Turn rate at action +1 [rad/s].
        control_hz: Steps a second [1/s].
        holonomic: Whether the action is (forward, left, turn) instead of (forward, turn).
        bearings: (N,) directions of the beams of `scan` in the laser frame [rad].
        range_max: Distance that reads 1 in `scan` [m].
        T_robot_lidar: Pose of the laser in the robot frame [m, m, rad].
        half_length: Half of the robot's length, rounded up to a millimetre [m].
        half_width: Half of its width, likewise [m].
        own_map: Asks for the robot's whole map, for those who plan ahead; None where nothing builds one. (Observation
            `map` shows what is around.)
    """

    max_speed: float = 1.3
    max_turn_rate: float = 2.0
    control_hz: float = 10.0
    holonomic: bool = False
    bearings: NDArray[np.float64] = field(default_factory=_default_bearings)
    range_max: float = 30.0
    T_robot_lidar: tuple[float, float, float] = (0.1, 0.0, 0.0)
    half_length: float = 0.275
    half_width: float = 0.259
    own_map: Callable[[], OwnMap] | None = None

    @property
    def turning_radius(self) -> float:
        """Half of the robot's diagonal, which is what it sweeps as it turns, rounded up to a centimetre [m]."""
        return math.ceil(100.0 * math.hypot(self.half_length, self.half_width)) / 100.0

    @property
    def field_of_view(self) -> float:
        """Angle that the laser looks at; all round, where its first and last beam are neighbours [rad]."""
        width = abs(float(self.bearings[-1] - self.bearings[0]))
        return 2.0 * math.pi if 2.0 * math.pi - width < 1.5 * width / max(len(self.bearings) - 1, 1) else width

    def along_scan(self, directions: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return where in a scan directions lie: 0 at its first beam, 1 at its last, more where the laser is blind.

        Args:
            directions: From the laser, in the robot frame [rad]. The laser may be turned, and its beams may be counted
                from anywhere, either way.
        """
        first, width = self.bearings[0], abs(self.bearings[-1] - self.bearings[0])
        way = np.sign(self.bearings[-1] - first)
        beyond = np.mod(way * (directions - self.T_robot_lidar[2] - first), 2.0 * np.pi)
        if self.field_of_view > width:  # what lies between its ends is at the nearer one
            beyond = np.where(beyond > 0.5 * width + np.pi, 0.0, np.minimum(beyond, width))
        return beyond / width
