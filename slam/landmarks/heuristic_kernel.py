"""The cut of a sweep where consecutive points are far apart, compiled, and its plain numpy reference."""

import numpy as np
from numba import njit
from numpy.typing import NDArray


@njit(cache=True, nogil=True)
def heuristic_labels(points: NDArray[np.float64], distance: float, min_points: int) -> NDArray[np.int64]:
    """Return (n,) the run that each of `points` (n, 2) belongs to, -1 in runs of fewer than `min_points`."""
    n = len(points)
    labels = np.full(n, -1, dtype=np.int64)
    start, cluster = 0, 0
    for i in range(1, n + 1):
        if i < n:
            dx, dy = points[i, 0] - points[i - 1, 0], points[i, 1] - points[i - 1, 1]
            if dx * dx + dy * dy <= distance * distance:
                continue
        if i - start >= min_points:
            labels[start:i] = cluster
            cluster += 1
        start = i
    return labels


def heuristic_labels_reference(points: NDArray[np.float64], distance: float, min_points: int) -> NDArray[np.int64]:
    """Do what `heuristic_labels` does, in numpy."""
    cuts = (np.diff(points, axis=0) ** 2).sum(axis=1) > distance * distance
    runs = np.concatenate(([0], np.cumsum(cuts)))[: len(points)]
    big = np.bincount(runs) >= min_points
    return np.where(big, np.cumsum(big) - 1, -1)[runs]
