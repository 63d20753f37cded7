"""Numba kernel of `LaserScan.beam_points`."""

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def fill_beam_points(ranges, directions, range_min, range_max, points):
    """Write into `points` (N, 2) where the beams `ranges` (N,) along `directions` (N, 2) end; NaN without a return."""
    for i in range(len(ranges)):
        away = ranges[i]
        if not (range_min <= away <= range_max):
            away = np.nan
        points[i, 0] = away * directions[i, 0]
        points[i, 1] = away * directions[i, 1]


def fill_beam_points_reference(ranges, directions, range_min, range_max, points):
    """Write what `fill_beam_points` writes, in plain numpy."""
    away = np.where((ranges >= range_min) & (ranges <= range_max), ranges, np.nan)
    points[:] = away[:, None] * directions
