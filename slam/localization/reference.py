"""The plain numpy twin of `evidence_kernels.py`."""

import numpy as np
from numpy.typing import NDArray

from ..geometry import transform_points
from .evidence_kernels import FLOOR, OCCUPIED, UNKNOWN, UNSEEN

Array = NDArray[np.float64]


def beam_likelihoods(
    states: NDArray[np.uint8],
    distances: NDArray[np.float32],
    corner: Array,
    resolution: float,
    foot: Array,
    points: Array,
    poses: Array,
    sigma: float,
    slack: float,
) -> Array:
    """Return what the kernel of that name writes, (k, N)."""
    result = np.empty((len(poses), len(points)))
    for k, pose in enumerate(poses):
        start = (transform_points(pose, foot[None])[0] - corner) / resolution
        ends = (transform_points(pose, points) - corner) / resolution
        for n, end in enumerate(ends):
            length = float(np.hypot(*(end - start)))
            steps = np.arange(1, int(length - slack / resolution) + 1)
            passed = start + (steps / length)[:, None] * (end - start)
            value = UNSEEN
            if _inside(states, end[None])[0]:
                j, i = np.floor(end).astype(int)
                value = FLOOR + (1.0 - FLOOR) * np.exp(-0.5 * distances[i, j] ** 2 / sigma**2)
                value = max(value, UNSEEN) if states[i, j] == UNKNOWN else value
            columns, rows = np.floor(passed[_inside(states, passed)]).astype(int).T
            result[k, n] = FLOOR if (states[rows, columns] == OCCUPIED).any() else value
    return result


def _inside(states: NDArray[np.uint8], cells: Array) -> NDArray[np.bool_]:
    return np.all((cells >= 0.0) & (cells < np.array(states.shape[::-1])), axis=1)
