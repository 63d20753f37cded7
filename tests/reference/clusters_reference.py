"""What the kernels of `perception.legs.clusters` compute, in plain numpy."""

import numpy as np
from numpy.typing import NDArray
from tagalong.perception.legs.clusters import LEAST_POINTS


def split_by_distance_reference(
    points: NDArray[np.float64], alpha: float, beta: int, beams_at_1m: float = 0.0
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return what `split_by_distance` returns, in plain numpy."""
    if len(points) == 0:
        return np.empty(0, np.int64), np.empty(0, np.int64)
    breaks = np.flatnonzero(np.sum(np.diff(points, axis=0) ** 2, axis=1) > alpha * alpha) + 1
    start = np.concatenate(([0], breaks))
    end = np.concatenate((breaks, [len(points)]))
    enough = np.full(len(start), beta)
    if beams_at_1m > 0.0:
        away = np.maximum(np.hypot(points[start, 0], points[start, 1]), 1e-6)
        enough = np.minimum(beta, np.maximum(LEAST_POINTS, (beams_at_1m / away).astype(np.int64)))
    large = end - start >= enough
    return start[large], end[large]
