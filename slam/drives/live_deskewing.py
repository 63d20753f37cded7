"""Scans of a laser that spins as if all of their beams had been measured at once, one after the other as they come.

`deskewed` has a whole recording to find out by how the laser measures, and the odometry after each scan. A robot has
neither: so it asks the scans of its first turns, and is taken to move on from a scan as it moved up to it.
"""

from collections import deque

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..bounds import checked_pose
from ..geometry import between, inverse
from ..scan import LaserScan
from .sweep_time import (
    NEIGHBOURS,
    PAIRS,
    Moment,
    SweepQuestion,
    SweepTime,
    straightened,
    turned_otherwise,
    usual_step_s,
    usual_ways,
)  # fmt: skip

Array = NDArray[np.float64]

_STEPS = 21  # between scans, of which the usual one is the median


class Deskewer:
    """Takes the robot's motion out of the scans of a laser that spins, as they come.

    Whether it spins, and which of its beams is the first, the scans of the first turns say (`sweep_time`): from ten
    pairs of them on, until sixty have told. Before that, scans stay as they are, and so do all of a laser that measures
    at once.

    Args:
        sweep: When the beams are measured, where that is known; None: to be found out.
    """

    def __init__(self, sweep: SweepTime | None = None) -> None:
        self._sweep, self._is_known = sweep, sweep is not None
        self._question: SweepQuestion | None = None
        self._moments: deque[Moment] = deque(maxlen=NEIGHBOURS)
        self._times_s: deque[float] = deque(maxlen=_STEPS)
        self._last: tuple[LaserScan, Array, Array] | None = None

    @property
    def sweep(self) -> SweepTime | None:
        """When the beams are measured, by all that is known; None: at once, or it is not known yet."""
        return self._sweep

    def update(self, odometry: ArrayLike, scan: LaserScan) -> tuple[LaserScan, NDArray[np.intp]]:
        """Take the next scan; return it as if measured at once, and (N,) which beam of `scan` each of its beams is.

        Args:
            odometry: (3,) T_odom_robot at its time [m, m, rad].
            scan: Later than the one before.

        Raises:
            InputError: If the pose is none.
        """
        pose = checked_pose(odometry)
        way = self._way(pose, scan.time_s)
        if not self._is_known:
            self._find_out(pose, way)
        self._last = scan, pose, inverse(way) if way.any() else way
        if self._sweep is None:
            return scan, np.arange(len(scan))
        return straightened(scan, self._last[2] if self._sweep.ended else way, self._sweep)

    def _way(self, pose: Array, time_s: float) -> Array:
        """Return (3,) how the robot moved, up to now, in the usual time between scans."""
        self._times_s.append(time_s)
        if self._last is None:
            return np.zeros(3)
        scan, before, _ = self._last
        usual_s = usual_step_s(np.array(self._times_s))
        return usual_ways(between(before, pose)[None], np.array([time_s - scan.time_s]), usual_s)[0]

    def _find_out(self, pose: Array, way: Array) -> None:
        """Ask the scan before, after which the robot went `way`, with one near it at which it turned otherwise."""
        if self._last is None:
            return
        scan, before, back = self._last
        moment = Moment(scan, before, way, back)
        which = turned_otherwise(moment, self._moments)
        if which is not None:
            self._question = self._question or SweepQuestion(scan)
            self._question.ask(self._moments[which], moment)
            self._sweep, self._is_known = self._question.answer, self._question.told >= PAIRS
        self._moments.append(moment)
