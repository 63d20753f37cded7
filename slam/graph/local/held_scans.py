"""Scans that wait for odometry that has stopped.

Odometry of real robots stands still for some scans while the robot drives on, and catches up in one. Where the robot
was meanwhile is known only then, and along a corridor no scan tells it before. So each scan at which the odometry has
not moved is looked at, but not drawn, until it moves again: by then it tells how far the robot went in all of them, and
they are matched along that way. Where the robot had stopped, they are taken as they would have been at once.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ...geometry import between
from ...scan import LaserScan
from .switching_motion import SwitchingMotion

Array = NDArray[np.float64]
Due = tuple[Array, LaserScan, Array | None]
"""A scan that is taken now: T_odom_robot (3,), the scan, and how far off that may be if it is interpolated (2,)."""

_MOST = 20  # scans wait: odometry that stands still for longer has failed, or the robot has stopped


class HeldScans:
    """The scans that wait, and the motion of the robot before them."""

    def __init__(self) -> None:
        self._scans: list[tuple[Array, LaserScan]] = []
        self._motion: SwitchingMotion | None = None  # as it was before the first
        self._released = False  # whether the odometry has stood still for so long that no scan waits any more

    def __len__(self) -> int:
        return len(self._scans)

    def wait(self, motion: SwitchingMotion, odometry: Array, scan: LaserScan) -> bool:
        """Let a scan wait if its odometry pose T_odom_robot (3,) is that of the scan before; return whether it does."""
        if not motion.stands_still(odometry) or self._released or len(self._scans) >= _MOST:
            return False
        self._motion = self._motion or motion.copy()
        self._scans.append((odometry, scan))
        return True

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
        whole = None if odometry is None else between(scans[0][0], odometry)
        if odometry is None or whole is None or stands or not motion.has_caught_up(odometry, len(scans) + 1):
            yield from ((at, scan, None) for at, scan in scans)
            return
        for k, (_, scan) in enumerate(scans):
            at, sigma = motion.bridge(odometry, len(scans) + 1 - k)
            yield at, scan, sigma
        motion.widen(whole)
