"""A scan made ready for localization."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..graph.voxel_filter import AdaptiveVoxelConfig, AdaptiveVoxelFilter
from ..scan import LaserScan

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class View:
    """What one scan saw.

    Attributes:
        odometry: (3,) T_odom_robot at its time.
        points: (N, 2) thinned returns, robot frame [m].
        foot: (2,) place of the laser, robot frame [m].
    """

    odometry: Array
    points: Array
    foot: Array


class ViewMaker:
    """Thins scans as local SLAM does.

    Args:
        config: Which points are kept.
    """

    def __init__(self, config: AdaptiveVoxelConfig) -> None:
        self._filter = AdaptiveVoxelFilter(config)

    def view(self, odometry: Array, scan: LaserScan) -> View:
        """Return the view of `scan`, taken at the odometry pose T_odom_robot (3,)."""
        return View(odometry, self._filter.apply(scan.points_robot), np.array(scan.T_robot_lidar[:2], np.float64))
