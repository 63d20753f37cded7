"""Odometry that stops while the robot drives on: from then on its scans tell how it moves, until the wheels do again.

An encoder fails, a cable comes off, a driver dies: the odometry stands still for the rest of the drive. Scans that are
matched one with another then lose less of the way than a guess that the robot goes on as before. How far it has gone by
the time that this is noticed is told in one step, as by wheels that catch up. A log without odometry is one whose
odometry never moves.
"""

import numpy as np
from numpy.typing import NDArray

from ..geometry import between, compose, inverse, stands
from ..scan import LaserScan
from .laser_odometry import ScanToScanOdometry

Array = NDArray[np.float64]

LONGEST_STOP = 10  # scans: odometry that stands still for so long may catch up yet, and then knows better
_PUSHED = np.array([0.3, 0.2])  # [m, rad] a robot that stands may be pushed so far
_SIGMAS = 3.0  # standard deviations by which its scans must have moved, too


class StoppedOdometry:
    """Puts odometry made of the scans in the place of one that has stopped.

    It has once it stood still for more than `LONGEST_STOP` scans and these show that the robot has surely moved.
    """

    def __init__(self) -> None:
        self._told: Array | None = None  # odometry as it comes
        self._pose = np.zeros(3)  # ... and as it is returned
        self._offset: Array | None = None  # T_returned_told; None: they are the same
        self._scan: LaserScan | None = None  # the last one
        self._stop: _Stop | None = None  # while the odometry stands still
        self._start = np.zeros(3)  # T_odom_robot where that began

    @property
    def has_stopped(self) -> bool:
        """Whether the scans stand for the odometry now."""
        return self._stop is not None and self._stop.is_fault

    @property
    def is_lost(self) -> bool:
        """Whether the scans stand for the odometry, and do not show where the robot went since the last one."""
        return self._stop is not None and self._stop.is_fault and self._stop.is_lost

    def apply(self, odometry: Array, scan: LaserScan) -> Array:
        """Return T_odom_robot (3,) at a scan that comes with the pose `odometry` (3,)."""
        last, self._told = self._told, odometry
        before, self._scan = self._scan, scan
        if last is None or before is None or not stands(between(last, odometry)):
            if last is not None and self.has_stopped:
                self._resume(last, odometry)
            self._stop, self._pose = None, self._whole(odometry)
            return self._pose
        if self._stop is None:
            self._stop, self._start = _Stop(before), self._pose
        self._stop.update(scan)
        self._pose = compose(self._start, self._stop.way) if self.has_stopped else self._whole(odometry)
        return self._pose

    def _whole(self, odometry: Array) -> Array:
        return odometry if self._offset is None else compose(self._offset, odometry)

    def _resume(self, last: Array, odometry: Array) -> None:
        """Believe odometry that moves again: it has told all the way meanwhile, or nothing of it."""
        went_on = compose(self._pose, between(last, odometry))
        if _way(self._pose, self._whole(odometry)) > _way(self._pose, went_on):
            self._offset = compose(went_on, inverse(odometry))


class _Stop:
    """What scans tell of a robot whose odometry stands still.

    Args:
        scan: The scan at which it began to.

    Attributes:
        way: (3,) T_start_robot of the newest scan.
        is_lost: Whether it is not known how that differs from the scan before.
    """

    def __init__(self, scan: LaserScan) -> None:
        self._front_end = ScanToScanOdometry()
        self.way = self._front_end.update(scan).pose
        self._scans, self.is_lost = 0, False
        self._from, self._variance = self.way, np.zeros(2)  # since when each step is known, and how well all together
        self._moved = False  # whether the robot has, surely

    def update(self, scan: LaserScan) -> None:
        """Take the next scan at which the odometry has not moved."""
        update = self._front_end.update(scan)
        self.way, self._scans = update.pose, self._scans + 1
        self.is_lost = bool((update.sigma > _PUSHED).any())
        if self.is_lost:
            self._from, self._variance = self.way, np.zeros(2)
            return
        self._variance += update.sigma**2
        x, y, turn = between(self._from, self.way)
        went = np.hypot(x, y), abs(turn)
        self._moved |= bool((went > np.maximum(_PUSHED, _SIGMAS * np.sqrt(self._variance))).any())

    @property
    def is_fault(self) -> bool:
        """Whether the odometry has failed, rather than that the robot stands."""
        return self._moved and self._scans > LONGEST_STOP


def _way(first: Array, second: Array) -> float:
    x, y, _ = between(first, second)
    return float(np.hypot(x, y))
