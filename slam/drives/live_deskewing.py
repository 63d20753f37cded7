"""Scans of a laser that spins as if all of their beams had been measured at once, one after the other as they come.

`deskewed` has a whole recording to find out by how the laser measures, and the odometry after each scan. On a robot the
scans of its first turns say the former; and where no odometry has come since a scan began, the robot is taken to move
on as it moved up to it.
"""

from collections import deque

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..bounds import checked_pose
from ..geometry import between, inverse
from ..scan import LaserScan
from .sweep_time import (
    NEIGHBOURS,
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
_TELLS = 0.5  # of the usual time between scans newer odometry is newer at least


class Deskewer:
    """Takes the robot's motion out of the scans of a laser that spins, as they come.

    Whether it spins, and which of its beams is the first, the scans say, as in `sweep_time`: those of the sixty fastest
    turns so far, from ten on. Before that, scans stay as they are, and so do all of a laser that measures at once. Of
    35 drives with such lasers two were taken for a while to take a quarter of the time; ten lasers that spin were known
    after 27 to 167 scans, but for one (871).

    Args:
        sweep: When the beams are measured, where that is known, or words of it (`SweepTime.from_words`), such as
            "1 clockwise"; None: to be found out.

    Raises:
        InputError: If the words name nothing of the kind.
    """

    def __init__(self, sweep: SweepTime | str | None = None) -> None:
        self._sweep = SweepTime.from_words(sweep) if isinstance(sweep, str) else sweep
        self._is_known = sweep is not None
        self._question: SweepQuestion | None = None
        self._moments: deque[Moment] = deque(maxlen=NEIGHBOURS)
        self._times_s: deque[float] = deque(maxlen=_STEPS)
        self._last: tuple[LaserScan, Array, Array] | None = None

    @property
    def sweep(self) -> SweepTime | None:
        """When the beams are measured, by all that is known; None: at once, or it is not known yet."""
        return self._sweep

    def update(
        self, odometry: ArrayLike, scan: LaserScan, newest: tuple[float, ArrayLike] | None = None
    ) -> tuple[LaserScan, NDArray[np.intp]]:
        """Take the next scan; return it as if measured at once, and (N,) which beam of `scan` each of its beams is.

        Args:
            odometry: (3,) T_odom_robot at its time [m, m, rad].
            scan: Later than the one before.
            newest: Time [s] and pose (3,) of the newest odometry, where some has come since: a scan that is told when
                its sweep ends leaves the time for that.

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
        back, onward = self._last[2], self._onward(pose, scan.time_s, newest)
        return straightened(scan, back if self._sweep.ended else way if onward is None else onward, self._sweep)

    def _onward(self, pose: Array, time_s: float, newest: tuple[float, ArrayLike] | None) -> Array | None:
        """Return (3,) how the robot moves in the usual time after `time_s`, by newer odometry; None: by none."""
        usual_s = usual_step_s(np.array(self._times_s))
        if newest is None or not 0.0 < _TELLS * usual_s <= newest[0] - time_s:
            return None
        motion = between(pose, checked_pose(newest[1])) * (usual_s / (newest[0] - time_s))
        return usual_ways(motion[None], np.array([usual_s]), 0.0)[0]

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
            self._sweep = self._question.answer
        self._moments.append(moment)
