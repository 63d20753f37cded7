"""Which landmarks of a map the robot could see, and which it should have seen but did not."""

import numpy as np
from numpy.typing import NDArray

from ..geometry import wrap_angle
from ..scan import LaserScan
from .filter import LandmarkFilter

Array = NDArray[np.float64]

_REACH = 1.5  # landmarks so much beyond the range are compared, too, besides three sigmas [m]
_PASSED = 1.0  # a beam that goes on so far behind a landmark's place has met nothing there [m]


def could_be_seen(ekf: LandmarkFilter, range_max: float) -> NDArray[np.int64]:
    """Return the numbers of the landmarks that a laser of `range_max` [m] could see, by what the filter believes."""
    apart = ekf.landmarks - ekf.x[:2]
    sigma = float(np.sqrt(np.trace(ekf.P[:2, :2])))
    return np.flatnonzero(np.hypot(apart[:, 0], apart[:, 1]) <= range_max + _REACH + 3.0 * sigma)


def seen_through(landmarks: Array, T_map_lidar: Array, scan: LaserScan, border: float) -> NDArray[np.bool_]:
    """Return (k,) whether the beam towards each landmark goes on behind it: it is not where it is believed.

    Args:
        landmarks: (k, 2) places, map frame [m].
        T_map_lidar: (3,) pose of the laser.
        scan: The scan.
        border: Twice so near to the end of the range nothing is said [m].
    """
    apart = landmarks - T_map_lidar[:2]
    r = np.hypot(apart[:, 0], apart[:, 1])
    bearing = wrap_angle(np.arctan2(apart[:, 1], apart[:, 0]) - T_map_lidar[2])
    if not len(scan):
        return np.zeros(len(r), dtype=np.bool_)
    bearing = np.where(bearing < scan.bearings[0], bearing + 2.0 * np.pi, bearing)  # of sweeps beyond pi
    inside = (bearing > scan.bearings[0]) & (bearing < scan.bearings[-1])
    beam = np.clip(np.searchsorted(scan.bearings, bearing), 0, len(scan) - 1)
    passed = np.where(np.isnan(scan.ranges[beam]), 0.0, scan.ranges[beam]) > r + _PASSED
    return inside & passed & (r < scan.range_max - 2.0 * border)
