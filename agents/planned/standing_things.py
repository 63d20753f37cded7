"""What stands around the robot: the returns of the laser, remembered until a beam goes through where they were."""

import numpy as np
from numpy.typing import NDArray

from ...envs.task.interface import FollowInterface
from ..protocol.follower import Observation
from ..scripted.scan_points import MOST_BEAMS, ScanPoints, own_velocity, scan_of

Array = NDArray[np.float64]

CELL_M = 0.05
"""Of returns that lie together, one is kept."""
SEEN_THROUGH_M = 0.15
"""A beam that goes on so far behind a remembered return says that it is gone; ten times the laser's noise [m]."""


class StandingThings:
    """Remembers what stands, in the moving robot frame.

    Args:
        interface: Where the beams look.
        reach: What is farther than this from the robot is forgotten [m].
        remembered_s: What no beam has met or passed for so long is forgotten [s]: odometry drifts.

    Attributes:
        met: (n, 2) all that the last scan met, robot frame [m].
    """

    def __init__(self, interface: FollowInterface, reach: float, remembered_s: float) -> None:
        self._reach, self._remembered_s = reach, remembered_s
        self._interface, self._scan = interface, ScanPoints(interface)
        self._step_s, self._count = 1.0 / interface.control_hz, len(interface.bearings)
        self._every = max(1, self._count // MOST_BEAMS)
        self.reset()

    def reset(self) -> None:
        """Forget everything."""
        self.met = np.zeros((0, 2))
        self._kept = np.zeros((0, 3))  # x, y [m], age [s]

    def update(self, observation: Observation, moving: Array, body: float) -> Array:
        """Take an observation, once a step; return (n, 2) what stands, robot frame [m].

        Args:
            observation: As of `FollowEnv`.
            moving: (k, 2) where people are who move, robot frame [m]: what is met there does not stand.
            body: Within so far of them [m].
        """
        self._carry_along(own_velocity(observation))
        self.met = new = self._scan.near(observation, self._reach)
        kept = self._kept[~self._seen_through(observation)]
        rows = np.vstack((np.column_stack((new, np.zeros(len(new)))), kept))
        rows = rows[(np.abs(rows[:, :2]).max(axis=1, initial=0.0) < self._reach) & (rows[:, 2] < self._remembered_s)]
        rows = rows[np.lexsort((rows[:, 1], rows[:, 0], rows[:, 2]))]  # whichever beam was the first
        cells = np.floor(rows[:, :2] / CELL_M).astype(np.int64)
        rows = rows[np.unique(cells[:, 0] * 100_003 + cells[:, 1], return_index=True)[1]]
        if len(moving):
            apart = np.hypot(rows[:, :1] - moving[:, 0], rows[:, 1:2] - moving[:, 1]).min(axis=1)
            rows = rows[apart > body]
        self._kept = rows
        return rows[:, :2]

    def _carry_along(self, velocity: tuple[float, float, float]) -> None:
        dx, dy, turned = (value * self._step_s for value in velocity)
        x, y, age = self._kept[:, 0] - dx, self._kept[:, 1] - dy, self._kept[:, 2] + self._step_s
        cos, sin = np.cos(turned), np.sin(turned)
        self._kept = np.column_stack((cos * x + sin * y, cos * y - sin * x, age))

    def _seen_through(self, observation: Observation) -> NDArray[np.bool_]:
        """Return (n,) whether a beam of this scan went on behind each return that is remembered."""
        scan = scan_of(observation, self._count)[:: self._every].astype(np.float64) * self._interface.range_max
        x, y, _ = self._interface.T_robot_lidar
        away = np.hypot(self._kept[:, 0] - x, self._kept[:, 1] - y)
        share = self._interface.along_scan(np.arctan2(self._kept[:, 1] - y, self._kept[:, 0] - x))
        beam = np.round(share * (self._count - 1) / self._every).astype(np.intp)
        return (share <= 1.0) & (scan[np.minimum(beam, len(scan) - 1)] > away + SEEN_THROUGH_M)
