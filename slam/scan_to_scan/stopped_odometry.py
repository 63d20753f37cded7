"""Odometry that stops while the robot drives on: from then on its scans tell how it moves, until the wheels do again.

An encoder fails, a cable comes off, a driver dies: the odometry stands still for the rest of the drive. Scans that are
matched one with another then lose less of the way than a guess that the robot goes on as before. How far it has gone by
the time that this is noticed is told in one step, as by wheels that catch up.
"""

from collections import deque
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..geometry import between, compose, inverse, stands
from ..scan import LaserScan
from .laser_odometry import ScanToScanOdometry

Array = NDArray[np.float64]

LONGEST_STOP = 20  # scans: odometry that stands still for longer has failed, or the robot stands


class StoppedOdometry:
    """Puts odometry made of the scans in the place of one that has stopped.

    It has once the robot moved in more than half as many as `LONGEST_STOP` of the newest scans in which it stood still.
    """

    def __init__(self) -> None:
        self._told: Array | None = None  # odometry as it comes
        self._pose = np.zeros(3)  # ... and as it is returned
        self._offset: Array | None = None  # T_returned_told; None: they are the same
        self._still = deque[LaserScan](maxlen=LONGEST_STOP + 2)  # scans since the odometry moved, that one first
        self._moved = deque[bool](maxlen=LONGEST_STOP)  # whether the robot moved, at each of the newest
        self._front_end: ScanToScanOdometry | None = None
        self._start = np.zeros(3)  # T_odom_robot where that began

    @property
    def has_stopped(self) -> bool:
        """Whether the scans stand for the odometry now."""
        return self._front_end is not None

    def apply(self, odometry: Array, scan: LaserScan) -> Array:
        """Return T_odom_robot (3,) at a scan that comes with the pose `odometry` (3,)."""
        last, self._told = self._told, odometry
        if last is None or not stands(between(last, odometry)):
            if last is not None and self._front_end:
                self._resume(last, odometry)
            self._still.clear()
            self._moved.clear()
        self._still.append(scan)
        scans: Sequence[LaserScan] = [scan]
        if not self._front_end:
            self._pose = self._whole(odometry)
            if sum(self._moved) > LONGEST_STOP / 2:
                self._front_end, self._start, scans = ScanToScanOdometry(), self._pose, self._still
        if self._front_end:
            for each in scans:
                self._pose = compose(self._start, self._front_end.update(each).pose)
        return self._pose

    def _whole(self, odometry: Array) -> Array:
        return odometry if self._offset is None else compose(self._offset, odometry)

    def _resume(self, last: Array, odometry: Array) -> None:
        """Believe odometry that moves again: it has told all the way meanwhile, or nothing of it."""
        self._front_end = None
        went_on = compose(self._pose, between(last, odometry))
        if _way(self._pose, self._whole(odometry)) > _way(self._pose, went_on):
            self._offset = compose(went_on, inverse(odometry))

    def learn(self, moved: bool) -> None:
        """Learn whether the robot `moved` to where the last scan was matched otherwise than its odometry says."""
        self._moved.append(moved)


def _way(first: Array, second: Array) -> float:
    x, y, _ = between(first, second)
    return float(np.hypot(x, y))
