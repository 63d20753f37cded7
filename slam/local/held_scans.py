"""Scans that wait for odometry that has stopped.

Odometry of real robots stands still for some scans while the robot drives on, and catches up in one. Where the robot
was meanwhile is known only then, and along a corridor no scan tells it before. So each scan at which the odometry has
not moved is looked at, but not drawn, until it moves again: by then it tells how far the robot went in all of them, and
they are matched along that way. Where the robot had stopped, they are taken as they would have been at once.
"""

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from ..geometry import between
from ..scan import LaserScan
from .bridge import Bridge
from .hypothesis_matching import Look
from .switching_motion import SwitchingMotion

Array = NDArray[np.float64]

_LONGEST = 20  # scans: odometry that stands still for longer has failed, or the robot stands


@dataclass(frozen=True, eq=False)
class Due:
    """A scan that is to be taken now.

    Attributes:
        odometry: (3,) T_odom_robot.
        scan: The scan.
        bridge: How the robot may have gone since the scan before; None: as that says, it is not interpolated.
        look: What was found when it was looked at; it holds where nothing was drawn since.
    """

    odometry: Array
    scan: LaserScan
    bridge: Bridge | None = None
    look: Look | None = None

    def known(self, drawn: int) -> Look | None:
        """Return what is known of the scan, once so many have been drawn; None: nothing that holds."""
        return self.look if self.look and self.look.drawn == drawn else None


@dataclass
class HeldScans:
    """The scans that wait.

    Attributes:
        scans: In order.
        motion: The motion of the robot as it was before the first; None: there is none.
        released: Whether the odometry has stood still for so long that no scan waits any more.
    """

    scans: list[Due] = field(default_factory=list)
    motion: SwitchingMotion | None = None
    released: bool = False
    _poses: list[Array] = field(default_factory=list)  # (3,) T_local_robot before the first, and where each seems to be

    def wait(self, motion: SwitchingMotion, odometry: Array, scan: LaserScan) -> bool:
        """Let a scan wait if its odometry pose T_odom_robot (3,) is that of the scan before; return whether it does."""
        if not motion.stands_still(odometry) or self.released or len(self.scans) >= _LONGEST:
            return False
        if self.motion is None:
            self.motion, self._poses = motion.copy(), [motion.pose]
        self.scans.append(Due(odometry, scan))
        return True

    def looked(self, look: Look, pose: Array) -> None:
        """Keep what was found when the newest was looked at, and that it seems to be at `pose` (3,), T_local_robot.

        All of what was found holds only if no other waits: what is made of those may change it.
        """
        self._poses.append(pose)
        if len(self.scans) == 1:
            self.scans[0] = replace(self.scans[0], look=look)

    @property
    def steps(self) -> Array:
        """(n + 1, 3) how the robot seems to have gone to each of the n scans, and on in the same way to the next."""
        poses = np.array(self._poses)
        steps = between(poses[:-1], poses[1:])
        return np.concatenate((steps, steps[-1:]))
