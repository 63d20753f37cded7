"""What the kernels of `perception.rgbd.growing` compute, in plain numpy."""

import numpy as np


def settle_reference(points, planes, region, radius, settled):
    """Do what `settle` does, in numpy: one pass over the picture for each plane."""
    best = 0.015 + 0.0012 * points[..., 0] ** 2
    best = np.where(np.isfinite(best), best, -1.0)
    settled[:] = -1
    reach = np.lib.stride_tricks.sliding_window_view(
        np.pad(region, radius, constant_values=-1), (2 * radius + 1, 2 * radius + 1)
    )
    for k, plane in enumerate(planes):
        near = (reach == k).any(axis=(2, 3))
        away = np.abs(np.nan_to_num(points) @ plane[:3] - plane[3])
        better = near & (away < best)
        settled[better], best[better] = k, away[better]
