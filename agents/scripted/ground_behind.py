"""How far back the ground is known to be free, where the laser may not look: it was seen so, or the robot stood there.

Some of the last views are kept and carried along by odometry, each with the place from which it was taken. Of a place
behind the robot the newest view counts that says anything about it: a beam went beyond it, or the robot's own box was
there: free; a beam ended there: not free. What no view tells of is not known, and not driven over.
"""

import numpy as np
from numpy.typing import NDArray

from ...envs.task.interface import FollowInterface
from ..protocol.follower import Observation
from .scan_points import MOST_BEAMS, own_velocity, scan_of

Array = NDArray[np.float64]

FARTHEST_M = 1.0
"""How far back is asked at most: the robot backs at 0.4 m/s, which it can stop within 0.1 m."""
_ROW_M = 0.05
_SECTOR_RAD = np.radians(5.0)  # 9 cm wide at one metre: no return in it hides beside a beam
_NOISE_M = 0.05  # four times the laser's
_SLACK_M = 0.03  # by which the robot's box on the way back may miss that on the way there
_VIEWS, _APART_M, _APART_RAD = 24, 0.12, 0.2  # 3 m of way, or most of a turn


class GroundBehind:
    """Remembers the views of one episode.

    Args:
        interface: Where the beams look, and how far; and the robot's size.
    """

    def __init__(self, interface: FollowInterface) -> None:
        half_length, half_width = interface.half_length, interface.half_width
        self._half, self._scale = np.array((half_length, half_width)), interface.range_max
        self._count = len(interface.bearings)
        self._beams = slice(None, None, max(1, len(interface.bearings) // MOST_BEAMS))
        bearings = interface.bearings[self._beams]
        self._sectors = max(1, round(abs(float(bearings[-1] - bearings[0])) / _SECTOR_RAD))
        self._starts = np.floor(np.arange(self._sectors) * len(bearings) / self._sectors).astype(np.intp)
        self._interface, self._step_s = interface, 1.0 / interface.control_hz
        rows = half_length + _ROW_M * np.arange(1, round(FARTHEST_M / _ROW_M) + 1)
        columns: Array = np.linspace(-half_width, half_width, 7)
        probes = np.column_stack((np.repeat(-rows, len(columns)), np.tile(columns, len(rows))))
        self._rows, self._probes = len(rows), probes.astype(np.float64)
        self.reset()

    def reset(self) -> None:
        """Forget everything."""
        self._poses = np.zeros((1, 3))  # of the robot at each view, in its frame of now, oldest first
        self._ranges = np.zeros((1, self._sectors))  # at first it has seen nothing, and stands where it stands
        self._room: float | None = None

    def observe(self, observation: Observation) -> None:
        """Take the view of an observation; once a step."""
        self._carry_along(own_velocity(observation))
        scan = scan_of(observation, self._count)[self._beams].astype(np.float64)
        view = np.minimum.reduceat(np.where(scan < 1.0, scan * self._scale, np.inf), self._starts)
        apart = np.abs(self._poses[-2:-1])
        if len(apart) and np.hypot(apart[0, 0], apart[0, 1]) < _APART_M and apart[0, 2] < _APART_RAD:
            self._poses, self._ranges = (
                self._poses[:-1],
                self._ranges[:-1],
            )  # the last stood about where that before did
        self._poses = np.vstack((self._poses, np.zeros(3)))[-_VIEWS:]
        self._ranges = np.vstack((self._ranges, view))[-_VIEWS:]
        self._room = None

    def room(self) -> float:
        """Return how far straight back every place under the robot would be known to be free, at most 1 m [m]."""
        if self._room is None:
            known = self._free(self._probes).reshape(self._rows, -1).all(axis=1)
            self._room = _ROW_M * float(np.argmin(np.append(known, False)))
        return self._room

    def _carry_along(self, velocity: tuple[float, float, float]) -> None:
        """Move the poses from the last robot frame into the present one."""
        dx, dy, turned = (value * self._step_s for value in velocity)
        cos, sin = np.cos(turned), np.sin(turned)
        x, y = self._poses[:, 0] - dx, self._poses[:, 1] - dy
        self._poses = np.column_stack((cos * x + sin * y, cos * y - sin * x, self._poses[:, 2] - turned))

    def _free(self, places: Array) -> NDArray[np.bool_]:
        """Return (n,) whether each of `places` (n, 2) is known to be free."""
        x, y = self._seen_from(places, self._poses)
        stood = (np.abs(x) <= self._half[0] + _SLACK_M) & (np.abs(y) <= self._half[1] + _SLACK_M)
        mount_x, mount_y, _ = self._interface.T_robot_lidar
        away = np.hypot(x - mount_x, y - mount_y)
        share = self._interface.along_scan(np.arctan2(y - mount_y, x - mount_x))
        sector = np.floor(share * self._sectors).astype(np.intp)
        inside = sector < self._sectors
        reach = self._ranges[np.arange(len(self._ranges))[:, None], np.minimum(sector, self._sectors - 1)]
        free = stood | (inside & (reach > away + _NOISE_M))
        says = free | (inside & (reach > away - _NOISE_M))
        newest = says.shape[0] - 1 - np.argmax(says[::-1], axis=0)
        return says.any(axis=0) & free[newest, np.arange(len(places))]

    @staticmethod
    def _seen_from(places: Array, poses: Array) -> tuple[Array, Array]:
        """Return (v, n) x and y of each of `places` in the frame of each of `poses` (v, 3)."""
        cos, sin = np.cos(poses[:, 2:]), np.sin(poses[:, 2:])
        dx, dy = places[:, 0] - poses[:, :1], places[:, 1] - poses[:, 1:2]
        return cos * dx + sin * dy, cos * dy - sin * dx
