"""Kernel of the grids of log-odds. Lengths are in cells."""

import numpy as np

from .rays import ray_start, ray_step
from .rigid_kernel import move_points
from .view_kernel import kernel


@kernel
def write_observation(x0, y0, ends, log_beta, miss, limit, stamp, log_odds, stamps):
    """Update each cell that the rays met once: by the first hit in it, else by `miss` where a ray passed.

    Args:
        x0, y0: Where the rays begin.
        ends: (n, 2) x, y of their ends; where two hit the same cell the earlier one counts.
        log_beta: (n,) what a hit adds to the log-odds; NaN where the ray ends in the open.
        miss: What a ray adds to a cell that it passes.
        limit: Log-odds stay within +-limit.
        stamp: Number of this observation, from 1; another one for each.
        log_odds: (rows, cols) float32, changed.
        stamps: (rows, cols) int32, the last observation that updated a cell, 0 if none; changed.
    """
    for k in range(len(ends)):
        row, col = int(np.floor(ends[k, 1])), int(np.floor(ends[k, 0]))
        if not np.isnan(log_beta[k]) and stamps[row, col] != stamp:
            stamps[row, col] = stamp
            log_odds[row, col] = max(min(log_odds[row, col] + log_beta[k], limit), -limit)
    for k in range(len(ends)):
        row, col, row_step, col_step, next_y, next_x, y_stride, x_stride, steps = ray_start(
            x0, y0, ends[k, 0], ends[k, 1]
        )
        for _ in range(steps):
            if stamps[row, col] != stamp:
                stamps[row, col] = stamp
                log_odds[row, col] = max(min(log_odds[row, col] + miss, limit), -limit)
            row, col, next_y, next_x = ray_step(row, col, row_step, col_step, next_y, next_x, y_stride, x_stride)


@kernel
def place_rays(places, points, firsts, resolution, starts, ends, spans):
    """Place the rays of n scans and say which cells each of them needs.

    Args:
        places: (n, 4) x, y of the sensors [m], cos and sin of their headings.
        points: (N, 2) where the rays end, sensor frames [m].
        firsts: (n + 1,) the rays of scan k are firsts[k] .. firsts[k + 1]; it has at least one.
        resolution: Side of a cell [m].
        starts: (n, 2) the sensors, written.
        ends: (N, 2) the ends of the rays, written.
        spans: (n, 2, 2) lowest x, y and highest x, y of each scan's start and ends, written.
    """
    for k in range(len(places)):
        rays = ends[firsts[k] : firsts[k + 1]]
        move_points(places[k, 0], places[k, 1], places[k, 2], places[k, 3], points[firsts[k] : firsts[k + 1]], rays)
        for axis in range(2):
            low = high = starts[k, axis] = places[k, axis] / resolution
            for n in range(len(rays)):
                rays[n, axis] /= resolution
                low, high = min(low, rays[n, axis]), max(high, rays[n, axis])
            spans[k, 0, axis], spans[k, 1, axis] = low, high


@kernel
def write_observations(starts, ends, firsts, corners, log_beta, miss, limit, stamp, log_odds, stamps):
    """Do what `write_observation` does for n scans, one after the other.

    Args:
        starts: (n, 2) x, y of where the rays of each begin, from the origin of the map.
        ends: (N, 2) x, y of where they end, likewise.
        firsts: (n + 1,) the rays of scan k are firsts[k] .. firsts[k + 1].
        corners: (n + 1, 2) x, y from which scan k counts its cells; the last one is that of cell [0, 0].
        log_beta: (N,) as of `write_observation`, and so are the rest.
        stamp: Number of the first scan.
    """
    for k in range(len(starts)):
        x, y = corners[k]
        rays = ends[firsts[k] : firsts[k + 1]] - corners[k]
        col, row = corners[k] - corners[-1]
        write_observation(
            starts[k, 0] - x, starts[k, 1] - y, rays, log_beta[firsts[k] : firsts[k + 1]], miss, limit, stamp + k,
            log_odds[row:, col:], stamps[row:, col:],
        )  # fmt: skip
