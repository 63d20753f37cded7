"""A scan made ready for localization."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..scan import LaserScan
from ..scan_to_grid.voxel_filter import AdaptiveVoxelConfig, AdaptiveVoxelFilter

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PreparedScan:
    """A scan made ready for localization.

    Attributes:
        odometry: (3,) T_odom_robot at its time.
        points: (N, 2) thinned returns, robot frame [m].
        sensor: (2,) place of the laser, robot frame [m].
    """

    odometry: Array
    points: Array
    sensor: Array


class ScanPreparation:
    """Thins scans as local SLAM does.

    Args:
        config: Which points are kept.
    """

    def __init__(self, config: AdaptiveVoxelConfig) -> None:
        self._filter = AdaptiveVoxelFilter(config)

    def prepare(self, odometry: Array, scan: LaserScan) -> PreparedScan:
        """Return `scan`, taken at the odometry pose T_odom_robot (3,), thinned."""
        return PreparedScan(
            odometry, self._filter.apply(scan.points_robot), np.array(scan.T_robot_lidar[:2], np.float64)
        )
