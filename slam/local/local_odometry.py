"""Odometry by local SLAM: how the robot moved, by its wheels and its scans together."""

import numpy as np
from numpy.typing import NDArray

from ..scan import LaserScan
from .learned_odometry import LearnedOdometry
from .local_slam import LocalSlam, LocalSlamConfig

Array = NDArray[np.float64]


class LocalOdometry:
    """Turns odometry that slips, freezes or is scaled into odometry that drifts slowly, by matching each scan.

    What it knows of the surroundings are the two growing submaps of local SLAM, so memory stays the same.

    Args:
        config: Settings of local SLAM.
    """

    def __init__(self, config: LocalSlamConfig) -> None:
        self._odometry = LearnedOdometry(config.extrapolator)
        self._local = LocalSlam(config, self._odometry.calibration)

    def update(self, odometry: Array, scan: LaserScan) -> Array:
        """Return (3,) T_local_robot of a scan that comes with the odometry pose T_odom_robot (3,)."""
        odometry = self._odometry.apply(odometry, scan)
        waits = self._local.wait(odometry, scan)
        result = waits or [self._local.take(due) for due in self._local.due(odometry, scan)][-1]
        self._odometry.learn(result, waits is not None)
        count = len(self._local.submaps)
        self._local.trim(np.arange(count) >= count - 2)
        return result.pose


class AsTold:
    """Stands in for `LocalOdometry` where the odometry is to be taken as it is."""

    def update(self, odometry: Array, scan: LaserScan) -> Array:
        """Return `odometry`."""
        return odometry
