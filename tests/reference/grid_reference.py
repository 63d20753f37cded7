"""The plain numpy twin of `grid_kernels.py`."""

import numpy as np
from numpy.typing import NDArray
from tagalong.slam.rays import ray_cells


def write_observation_reference(
    x0: float,
    y0: float,
    ends: NDArray[np.float64],
    log_beta: NDArray[np.float64],
    miss: float,
    limit: float,
    stamp: int,
    log_odds: NDArray[np.float32],
    stamps: NDArray[np.int32],
) -> None:
    """Do what `write_observation` does, in numpy."""
    change = np.full(log_odds.shape, np.nan)
    for (x, y), value in zip(np.floor(ends).astype(int), log_beta, strict=True):
        if np.isnan(change[y, x]):
            change[y, x] = value
    for x, y in ends:
        rows, cols = ray_cells(x0, y0, x, y)[:-1].T
        free = np.isnan(change[rows, cols])
        change[rows[free], cols[free]] = miss
    met = ~np.isnan(change)
    log_odds[met] = np.clip(log_odds[met] + change[met], -limit, limit)
    stamps[met] = stamp
