"""DBSCAN for the few points of one scan, compiled."""

import numpy as np
from numpy.typing import NDArray

from ..view_kernel import kernel


@kernel
def dbscan_labels(points: NDArray[np.float64], epsilon: float, min_points: int) -> NDArray[np.int64]:
    """Return (n,) the cluster of each of `points` (n, 2), -1 for noise; all pairs are compared.

    Clusters are numbered, and border points given to one, in the order of scikit-learn's DBSCAN, the oracle in the
    tests. A point counts as its own neighbour (Urvina 2023, eq. 13).
    """
    n = len(points)
    count = np.zeros(n, dtype=np.int64)
    for i in range(n):
        for j in range(n):
            dx, dy = points[i, 0] - points[j, 0], points[i, 1] - points[j, 1]
            count[i] += dx * dx + dy * dy <= epsilon * epsilon
    labels = np.full(n, -1, dtype=np.int64)
    stack = np.empty(n, dtype=np.int64)  # a point is put there once, when it gets its label
    cluster = 0
    for seed in range(n):
        if labels[seed] != -1 or count[seed] < min_points:
            continue
        labels[seed] = cluster
        stack[0] = seed
        size = 1
        while size:
            size -= 1
            i = stack[size]
            if count[i] < min_points:
                continue
            for j in range(n):
                if labels[j] != -1:
                    continue
                dx, dy = points[i, 0] - points[j, 0], points[i, 1] - points[j, 1]
                if dx * dx + dy * dy <= epsilon * epsilon:
                    labels[j] = cluster
                    stack[size] = j
                    size += 1
        cluster += 1
    return labels
