"""The cut of a sweep where consecutive points are far apart, compiled."""

import numpy as np
from numpy.typing import NDArray

from ..view_kernel import kernel


@kernel
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
