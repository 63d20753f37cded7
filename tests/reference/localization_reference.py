"""The plain numpy twin of `evidence_kernels.py`."""

import numpy as np
from numpy.typing import NDArray
from tagalong.slam.geometry import transform_points
from tagalong.slam.localization.evidence_kernels import BESIDE, FLOOR, OBLIQUE, OCCUPIED, UNKNOWN, UNSEEN

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
            blocked = _is_blocked(states, start, end, slack / resolution)
            value = UNSEEN
            if _inside(states, end[None])[0]:
                j, i = np.floor(end).astype(int)
                value = FLOOR + (1.0 - FLOOR) * np.exp(-0.5 * distances[i, j] ** 2 / sigma**2)
                value = max(value, UNSEEN) if states[i, j] == UNKNOWN else value
            result[k, n] = FLOOR if blocked else value
    return result


def _is_blocked(states: NDArray[np.uint8], start: Array, end: Array, slack: float) -> bool:
    """Return whether a wall that goes on to both sides stands on the way; lengths in cells."""
    length = float(np.hypot(*(end - start)))
    along = (end - start) / length
    passed = start + np.arange(1, int(length - slack) + 1)[:, None] * along
    stops = passed[_occupied(states, passed)]
    around = stops[:, None] + np.arange(-OBLIQUE, OBLIQUE + 1)[:, None] * along
    across = BESIDE * np.array([-along[1], along[0]])
    sides = [_occupied(states, (around + side).reshape(-1, 2)).reshape(around.shape[:2]) for side in (across, -across)]
    return bool((sides[0].any(axis=1) & sides[1].any(axis=1)).any())


def _occupied(states: NDArray[np.uint8], cells: Array) -> NDArray[np.bool_]:
    result = _inside(states, cells)
    columns, rows = np.floor(cells[result]).astype(int).T
    result[result] = states[rows, columns] == OCCUPIED
    return result


def _inside(states: NDArray[np.uint8], cells: Array) -> NDArray[np.bool_]:
    return np.all((cells >= 0.0) & (cells < np.array(states.shape[::-1])), axis=1)
