"""The sweeps of one control period with the odometry at their times."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ...slam.geometry import between, compose
from ...slam.scan import LaserScan

Array = NDArray[np.float64]


def timed_odometry(
    scans: tuple[LaserScan, ...], start_s: float, before: Array, end_s: float, after: Array
) -> Iterator[tuple[LaserScan, Array]]:
    """Yield each sweep taken after `start_s` with its odometry T_odom_robot (3,).

    Args:
        scans: Sweeps, oldest first; those that are not new are left out.
        start_s: Time of the odometry `before` (3,) [s].
        before: Odometry at the beginning of the period.
        end_s: Time of the odometry `after` (3,) [s].
        after: Odometry at its end; in between, the robot is taken to have moved evenly.
    """
    motion = between(before, after)
    for scan in scans:
        if scan.time_s > start_s + 1e-9:
            share = (scan.time_s - start_s) / (end_s - start_s)
            yield scan, after if share > 1.0 - 1e-9 else compose(before, share * motion)
