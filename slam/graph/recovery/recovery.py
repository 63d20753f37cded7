"""What graph SLAM asks of whoever looks after a robot that may be lost, and nobody who does."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ...scan import LaserScan
from ..local.local_slam import LocalResult
from ..loops.trimming import Renumbering

Array = NDArray[np.float64]


class Recovery(Protocol):
    """Looks at what local SLAM makes of each scan.

    Attributes:
        losses: How often the robot was lost.
        relocalizations: How often it was found again.
    """

    losses: int
    relocalizations: int

    def review(self, result: LocalResult, odometry: Array, scan: LaserScan) -> LocalResult:
        """Return the result that counts: as given, or what local SLAM makes of the same scan once more.

        Args:
            result: What local SLAM made of the scan.
            odometry: (3,) T_odom_robot.
            scan: The scan.
        """
        ...

    def relocalize(self, odometry: Array, scan: LaserScan, pose_local: Array) -> None:
        """Go on with the search for a lost robot; when it is found, place the drive segment on the map.

        Args:
            odometry: (3,) T_odom_robot.
            scan: The scan.
            pose_local: (3,) T_local_robot of the scan, after review.
        """
        ...

    def finish(self) -> None:
        """Take note that the drive has ended."""
        ...

    def located(self, result: LocalResult) -> bool:
        """Return whether it is known where on the map the robot is, after a scan of which this came."""
        ...

    @property
    def holds_nodes(self) -> bool:
        """Whether nodes are being looked at, so that none may leave the graph now."""
        ...

    def trim(self, stay: Renumbering) -> None:
        """Take the new numbers of the nodes that stay in the graph."""
        ...


class NoRecovery:
    """Believes every scan: the robot is never lost."""

    losses = relocalizations = 0
    holds_nodes = False

    def review(self, result: LocalResult, odometry: Array, scan: LaserScan) -> LocalResult:
        """Return the result as it is."""
        del odometry, scan
        return result

    def relocalize(self, odometry: Array, scan: LaserScan, pose_local: Array) -> None:
        """Do nothing."""

    def finish(self) -> None:
        """Do nothing."""

    def located(self, result: LocalResult) -> bool:
        """Return true."""
        del result
        return True

    def trim(self, stay: Renumbering) -> None:
        """Do nothing."""
