"""How far a laser sees."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...slam.geometry import compose
from ...slam.scan import LaserScan
from ...slam.view_kernel import kernel
from .detector import beams_of

Array = NDArray[np.float64]


class RangeView(NamedTuple):
    """How far a laser sees, in the odometry frame.

    Attributes:
        ranges: (N,) along the beams, the largest range where nothing was hit, 0 where nothing is known [m].
        first: Bearing of the first beam in the laser's frame [rad].
        step: Angle between two beams [rad].
        laser: (3,) T_odom_lidar.
    """

    ranges: Array
    first: float
    step: float
    laser: Array


def seen_in(scan: LaserScan, robot_pose: ArrayLike) -> RangeView:
    """Return the view of a scan, whose beams are at equal angles, with the robot at `robot_pose` (3,)."""
    return view_of(scan.ranges, beams_of(scan), np.asarray(compose(robot_pose, scan.T_robot_lidar)))


@kernel
def view_of(ranges, beams, lidar):
    """Return the view of `ranges` (N,) along `beams` from `lidar` (3,), T_odom_lidar."""
    far = np.zeros(len(ranges))
    for i in range(len(ranges)):
        if ranges[i] >= beams.range_min:
            far[i] = min(ranges[i], beams.range_max)
    step = (beams.bearings[-1] - beams.bearings[0]) / max(len(ranges) - 1, 1) if len(ranges) else 0.0
    return RangeView(far, beams.bearings[0] if len(ranges) else 0.0, step, lidar)
