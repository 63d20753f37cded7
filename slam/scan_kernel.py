"""Numba kernels of `LaserScan`: where its beams end."""

import numpy as np

from .view_kernel import kernel


@kernel
def fill_beam_points(ranges, directions, range_min, range_max, points):
    """Write into `points` (N, 2) where the beams `ranges` (N,) along `directions` (N, 2) end; NaN without a return."""
    for i in range(len(ranges)):
        away = ranges[i]
        if not (range_min <= away <= range_max):
            away = np.nan
        points[i, 0] = away * directions[i, 0]
        points[i, 1] = away * directions[i, 1]


@kernel
def returns(ranges, directions, range_min, range_max):
    """Return the ends (M, 2) of the beams that met something, in their order, and the number (M,) of each beam."""
    points = np.empty((len(ranges), 2))
    beams = np.empty(len(ranges), np.int64)
    count = 0
    for i in range(len(ranges)):
        away = ranges[i]
        if range_min <= away <= range_max:
            points[count, 0] = away * directions[i, 0]
            points[count, 1] = away * directions[i, 1]
            beams[count] = i
            count += 1
    return points[:count], beams[:count]
