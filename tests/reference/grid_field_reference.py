"""The way to everywhere on a grid in plain Python: what the kernel must agree with."""

import heapq

import numpy as np
from numpy.typing import NDArray

_STEPS = [(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1) if i or j]


def way_field_reference(cost: NDArray[np.float64], row: int, col: int) -> NDArray[np.float64]:
    """Return the `field` of `way_field`, by Dijkstra's algorithm."""
    field = np.full(cost.shape, np.inf)
    field[row, col] = 0.0
    heap = [(0.0, row, col)]
    while heap:
        so_far, r, c = heapq.heappop(heap)
        if so_far > field[r, c]:
            continue
        for dr, dc in _STEPS:
            i, j = r + dr, c + dc
            if not (0 <= i < cost.shape[0] and 0 <= j < cost.shape[1]) or not np.isfinite(cost[i, j]):
                continue
            if dr and dc and not (np.isfinite(cost[r, j]) and np.isfinite(cost[i, c])):
                continue
            new = so_far + 0.5 * (min(cost[r, c], 1e6) + cost[i, j]) * np.hypot(dr, dc)
            if new < field[i, j] - 1e-12:
                field[i, j] = new
                heapq.heappush(heap, (new, i, j))
    return field
