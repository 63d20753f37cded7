"""Kernel of the way to everywhere on a grid."""

import numpy as np

from ...slam.view_kernel import kernel

_ROWS = np.array([-1, 1, 0, 0, -1, -1, 1, 1])
_COLS = np.array([0, 0, -1, 1, -1, 1, -1, 1])


@kernel
def way_field(cost, row, col, field, parent):
    """Write the cheapest way from one cell to each, by relaxing cells in turn until nothing gets cheaper.

    Args:
        cost: (rows, cols) float64 cost of a cell; inf where nobody can be. A step costs the mean of its two cells times
            its length (1 or sqrt 2). Diagonal steps need both neighbours free.
        row, col: Where ways begin.
        field: (rows, cols) float64, written: cost of the way; inf where there is none.
        parent: (rows, cols) int32, written: flat index of the cell before on the way; -1 at the start.
    """
    rows, cols = cost.shape
    size = rows * cols
    queue = np.empty(size, dtype=np.int32)
    waiting = np.zeros(size, dtype=np.bool_)
    field[:] = np.inf
    parent[:] = -1
    field[row, col] = 0.0
    queue[0] = row * cols + col
    head, count = 0, 1
    while count > 0:
        cell = queue[head]
        head = (head + 1) % size
        count -= 1
        waiting[cell] = False
        r, c = cell // cols, cell % cols
        for k in range(8):
            i, j = r + _ROWS[k], c + _COLS[k]
            if i < 0 or j < 0 or i >= rows or j >= cols or not np.isfinite(cost[i, j]):
                continue
            if k >= 4 and not (np.isfinite(cost[r, j]) and np.isfinite(cost[i, c])):
                continue
            length = 1.0 if k < 4 else np.sqrt(2.0)
            new = field[r, c] + 0.5 * (min(cost[r, c], 1e6) + cost[i, j]) * length
            if new < field[i, j] - 1e-9:
                field[i, j] = new
                parent[i, j] = cell
                if not waiting[i * cols + j]:
                    waiting[i * cols + j] = True
                    queue[(head + count) % size] = i * cols + j
                    count += 1
