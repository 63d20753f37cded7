"""Kernel of the log-odds grid, and its plain numpy reference. Lengths are in cells."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from .rays import ray_cells, ray_start


@njit(cache=True, nogil=True)
def write_scan(x0, y0, ends, is_hit, hit, miss, limit, stamp, log_odds, stamps):
    """Update each cell that the scan met once: by `hit` where a ray ended on something, else by `miss`.

    Args:
        x0, y0: Where the rays begin.
        ends: (n, 2) x, y of their ends.
        is_hit: (n,) whether a ray ended on something; else its last cell is neither hit nor missed.
        hit, miss: Log-odds to add.
        limit: Log-odds stay within +-limit.
        stamp: Number of this scan, from 1; another one for each scan.
        log_odds: (rows, cols) float32, changed.
        stamps: (rows, cols) int32, the last scan that updated a cell, 0 if none; changed.
    """
    for k in range(len(ends)):
        row, col = int(np.floor(ends[k, 1])), int(np.floor(ends[k, 0]))
        if is_hit[k] and stamps[row, col] != stamp:
            stamps[row, col] = stamp
            log_odds[row, col] = min(log_odds[row, col] + hit, limit)
    for k in range(len(ends)):
        row, col, row_step, col_step, next_y, next_x, y_stride, x_stride, steps = ray_start(
            x0, y0, ends[k, 0], ends[k, 1]
        )
        for _ in range(steps):
            if stamps[row, col] != stamp:
                stamps[row, col] = stamp
                log_odds[row, col] = max(log_odds[row, col] + miss, -limit)
            if next_x < next_y:
                next_x += x_stride
                col += col_step
            else:
                next_y += y_stride
                row += row_step


def write_scan_reference(
    x0: float,
    y0: float,
    ends: NDArray[np.float64],
    is_hit: NDArray[np.bool_],
    hit: float,
    miss: float,
    limit: float,
    stamp: int,
    log_odds: NDArray[np.float32],
    stamps: NDArray[np.int32],
) -> None:
    """Do what `write_scan` does, in numpy."""
    struck = np.zeros(log_odds.shape, dtype=bool)
    passed = np.zeros(log_odds.shape, dtype=bool)
    cells = np.floor(ends).astype(int)
    struck[cells[is_hit, 1], cells[is_hit, 0]] = True
    for x, y in ends:
        rows, cols = ray_cells(x0, y0, x, y)[:-1].T
        passed[rows, cols] = True
    passed &= ~struck
    log_odds[struck] = np.minimum(log_odds[struck] + np.float32(hit), limit)
    log_odds[passed] = np.maximum(log_odds[passed] + np.float32(miss), -limit)
    stamps[struck | passed] = stamp
