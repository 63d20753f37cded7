"""The cells that a ray crosses (Amanatides and Woo 1987), for the kernels of every grid. Lengths are in cells."""

import numpy as np
from numpy.typing import NDArray

from .view_kernel import kernel, spliced_kernel


@kernel
def ray_start(x0, y0, x1, y1):
    """Return what a walk from cell to cell needs.

    That is (row, col, row step, col step, next y, next x, y stride, x stride, steps): `next` and `stride` are shares
    of the ray at which it crosses into another row (y) or column (x); after `steps` steps the walk is in the last cell.
    """
    col, row = int(np.floor(x0)), int(np.floor(y0))
    steps = abs(int(np.floor(x1)) - col) + abs(int(np.floor(y1)) - row)
    dx, dy = x1 - x0, y1 - y0
    col_step, row_step = (1 if dx > 0.0 else -1), (1 if dy > 0.0 else -1)
    next_x = (col + (1 if dx > 0.0 else 0) - x0) / dx if dx != 0.0 else np.inf
    next_y = (row + (1 if dy > 0.0 else 0) - y0) / dy if dy != 0.0 else np.inf
    x_stride = abs(1.0 / dx) if dx != 0.0 else np.inf
    y_stride = abs(1.0 / dy) if dy != 0.0 else np.inf
    return row, col, row_step, col_step, next_y, next_x, y_stride, x_stride, steps


@spliced_kernel
def ray_step(row, col, row_step, col_step, next_y, next_x, y_stride, x_stride):
    """Return (row, col, next y, next x) one step on."""
    if next_x < next_y:
        next_x += x_stride
        col += col_step
    else:
        next_y += y_stride
        row += row_step
    return row, col, next_y, next_x


def ray_cells(x0: float, y0: float, x1: float, y1: float) -> NDArray[np.int64]:
    """Return (n, 2) row and column of each cell from (x0, y0) to (x1, y1), both ends included, in their order.

    The reference of the kernels: the ray is cut at every grid line, the middle of each piece names its cell.
    """
    start, end = np.array([y0, x0]), np.array([y1, x1])
    cuts = [np.array([0.0, 1.0])]
    for axis in (0, 1):
        low, high = sorted((start[axis], end[axis]))
        lines = np.arange(np.floor(low) + 1.0, np.ceil(high))
        if len(lines):
            cuts.append((lines - start[axis]) / (end[axis] - start[axis]))
    shares = np.sort(np.concatenate(cuts))
    middles = start + (0.5 * (shares[:-1] + shares[1:]))[:, None] * (end - start)
    cells = np.floor(middles).astype(np.int64)
    return cells[np.concatenate(([True], np.any(np.diff(cells, axis=0) != 0, axis=1)))]
