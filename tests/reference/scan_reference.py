"""The plain numpy twin of `scan_kernel.py`."""

import numpy as np


def fill_beam_points_reference(ranges, directions, range_min, range_max, points):
    """Write what `fill_beam_points` writes, in plain numpy."""
    away = np.where((ranges >= range_min) & (ranges <= range_max), ranges, np.nan)
    points[:] = away[:, None] * directions
