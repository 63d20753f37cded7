"""Kernel that marks what a sweep of rays saw, and its plain reference. Lengths are in cells."""

import numpy as np
from numpy.typing import NDArray

from ...slam.rays import ray_cells, ray_start, ray_step
from ...slam.view_kernel import kernel


@kernel
def sweep(x0, y0, ends, blocked, seen):
    """Mark in `seen` each cell that a ray passed, up to the first blocked one; a ray's last cell is not passed.

    Args:
        x0, y0: Where the rays begin.
        ends: (n, 2) x, y of their ends.
        blocked: (rows, cols) bool, where rays end early; they end at the border, too.
        seen: (rows, cols) bool, changed.
    """
    rows, cols = seen.shape
    for k in range(len(ends)):
        row, col, row_step, col_step, next_y, next_x, y_stride, x_stride, steps = ray_start(
            x0, y0, ends[k, 0], ends[k, 1]
        )
        for _ in range(steps):
            if row < 0 or col < 0 or row >= rows or col >= cols or blocked[row, col]:
                break
            seen[row, col] = True
            row, col, next_y, next_x = ray_step(row, col, row_step, col_step, next_y, next_x, y_stride, x_stride)


def sweep_reference(
    x0: float, y0: float, ends: NDArray[np.float64], blocked: NDArray[np.bool_], seen: NDArray[np.bool_]
) -> None:
    """Do what `sweep` does, in numpy."""
    for x, y in ends:
        cells = ray_cells(x0, y0, x, y)[:-1]
        inside = np.all((cells >= 0) & (cells < seen.shape), axis=1)
        stops = ~inside
        stops[inside] = blocked[tuple(cells[inside].T)]
        passed = cells[: int(np.argmax(stops))] if stops.any() else cells
        seen[tuple(passed.T)] = True
