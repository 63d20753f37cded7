"""Scans that wait for odometry that has stopped.

Odometry of real robots stands still for some scans while the robot drives on, and catches up in one. Where the robot
was meanwhile is known only then, and along a corridor no scan tells it before. So each scan at which the odometry has
not moved is looked at, but not drawn, until it moves again: by then it tells how far the robot went in all of them, and
they are matched along that way. Where the robot had stopped, they are taken as they would have been at once.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...geometry import between
from ...scan import LaserScan
from ...scan_to_grid.scan_matcher import GridMatch
from .switching_motion import MotionHypothesis, SwitchingMotion

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Look:
    """What was found when a scan was matched, and nothing more done.

    Attributes:
        points: (N, 2) that were matched, robot frame [m].
        hypotheses: How the robot may have moved.
        motion: The one that holds.
        match: Where the scan fits; None: nowhere.
        lead: Logarithm of how many times likelier a fault is than sound odometry.
        drawn: So many scans had been drawn into submaps.
    """

    points: Array
    hypotheses: list[MotionHypothesis]
    motion: MotionHypothesis
    match: GridMatch | None
    lead: float
    drawn: int


@dataclass(frozen=True, eq=False)
class Due:
    """A scan that is to be taken now.

    Attributes:
        odometry: (3,) T_odom_robot.
        scan: The scan.
        bridge: (2,) how far off the odometry may be [m, rad]; None: it is not interpolated.
        look: What was found when it was looked at, if that holds where nothing was drawn since.
    """

    odometry: Array
    scan: LaserScan
    bridge: Array | None = None
    look: Look | None = None


_MOST = 20  # scans wait: odometry that stands still for longer has failed, or the robot has stopped


class HeldScans:
    """The scans that wait, and the motion of the robot before them."""

    def __init__(self) -> None:
        self._scans: list[Due] = []
        self._motion: SwitchingMotion | None = None  # as it was before the first
        self._released = False  # whether the odometry has stood still for so long that no scan waits any more

    def __len__(self) -> int:
        return len(self._scans)

    def wait(self, motion: SwitchingMotion, odometry: Array, scan: LaserScan) -> bool:
        """Let a scan wait if its odometry pose T_odom_robot (3,) is that of the scan before; return whether it does."""
        if not motion.stands_still(odometry) or self._released or len(self._scans) >= _MOST:
            return False
        self._motion = self._motion or motion.copy()
        self._scans.append(Due(odometry, scan))
        return True

    def looked(self, look: Look) -> None:
        """Keep what was found when the newest was looked at."""
        self._scans[-1] = replace(self._scans[-1], look=look)

    def due(self, motion: SwitchingMotion, odometry: Array | None) -> Iterator[Due]:
        """Yield the scans that have waited, in order; each is to be taken before the next is asked for.

        Args:
            motion: The motion as it is now; it is set back to what it was before them.
            odometry: (3,) T_odom_robot of the scan that comes next; None: there is none.
        """
        stands = odometry is not None and motion.stands_still(odometry)
        scans, before = self._scans, self._motion
        self._scans, self._motion, self._released = [], None, stands
        if before is None:
            return
        motion.return_to(before)
        if odometry is None or stands or not motion.has_caught_up(odometry, len(scans) + 1):
            yield from scans
            return
        for k, due in enumerate(scans):
            at, sigma = motion.bridge(odometry, len(scans) + 1 - k)
            yield Due(at, due.scan, sigma)
        motion.widen(between(scans[0].odometry, odometry))
