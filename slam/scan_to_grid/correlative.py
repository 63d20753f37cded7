"""Real-time correlative search: every pose of a small window is scored (Olson 2009)."""

import numpy as np
from numpy.typing import NDArray

from ..search.lanes import LANES
from ..view_kernel import kernel
from .sharp_sums import ROWS, set_sharp_sums

Array = NDArray[np.float64]


@kernel
def correlate(
    field: NDArray[np.float32],
    corner: Array,
    resolution: float,
    points: Array,
    prior: Array,
    prior_information: Array,
    weight: float,
    reach: int,
    angles: int,
    angle_step: float,
) -> tuple[Array, float]:
    """Return (pose (3,), sum of 1 - M) of the best pose of a window around `prior`.

    Candidates are `prior` + (i, j) cells, |i|, |j| <= reach, and + k `angle_step`, |k| <= angles; a point is worth
    M = 1.7 times the occupancy of the cell that it falls into, at most 1. Lowest weight * sum (1 - M) + 1/2 Mahalanobis
    distance to the prior wins; of equals the first, headings outside, rows inside.
    """
    side, P, best, best_pose, best_rest = 2 * reach + 1, prior_information, np.inf, prior.copy(), float(len(points))
    width, height = -(-side // LANES) * LANES, -(-side // ROWS) * ROWS
    scores, starts = np.empty(height * width, np.float32), np.empty(len(points), np.int64)
    corners, edge = np.empty((len(points), 2), np.int64), np.empty(len(points) * ROWS * LANES, np.float32)
    flat, cols = field.ravel(), field.shape[1]
    for k in range(-angles, angles + 1):
        dt = k * angle_step
        pose = prior[0], prior[1], prior[2] + dt
        count, beyond = _windows(field.shape, corner, resolution, points, pose, reach, height, width, starts, corners)
        for b in range(0, height, ROWS):
            for a in range(0, width, LANES):
                _copy_windows(field, corners[:beyond], b, a, edge)
                set_sharp_sums(scores, b * width + a, width, flat, cols, edge, starts, count, b * cols + a)  # pyright: ignore[reportCallIssue]
        for b in range(side):
            dy = (b - reach) * resolution
            for a in range(side):
                rest = len(points) - scores[b * width + a]
                if weight * rest >= best:  # the prior can only add to it
                    continue
                dx = (a - reach) * resolution
                pull = P[0, 0] * dx * dx + P[1, 1] * dy * dy + P[2, 2] * dt * dt
                pull += 2.0 * (P[0, 1] * dx * dy + P[0, 2] * dx * dt + P[1, 2] * dy * dt)
                total = weight * rest + 0.5 * pull
                if total < best:
                    best, best_rest = total, rest
                    best_pose[0], best_pose[1], best_pose[2] = prior[0] + dx, prior[1] + dy, prior[2] + dt
    return best_pose, best_rest


@kernel
def _windows(shape, corner, resolution, points, pose, reach, height, width, starts, corners):  # type: ignore[no-untyped-def]
    """Return how many points have a window that meets the field, and how many of these reach beyond it.

    `starts` are written as `set_sharp_sums` takes them, and the (row, column) of those beyond to `corners`.
    """
    c, s, count, beyond = np.cos(pose[2]), np.sin(pose[2]), 0, 0
    rows, cols = shape
    for n in range(len(points)):
        x = pose[0] + c * points[n, 0] - s * points[n, 1] - corner[0]
        y = pose[1] + s * points[n, 0] + c * points[n, 1] - corner[1]
        i, j = int(np.floor(x / resolution + 0.5)) - reach, int(np.floor(y / resolution + 0.5)) - reach
        if i >= cols or j >= rows or i + width <= 0 or j + height <= 0:
            continue
        if i >= 0 and j >= 0 and i + width <= cols and j + height <= rows:
            starts[count] = j * cols + i
        else:
            starts[count] = -1 - beyond * ROWS * LANES
            corners[beyond, 0], corners[beyond, 1] = j, i
            beyond += 1
        count += 1
    return count, beyond


@kernel
def _copy_windows(field, corners, row, col, edge):  # type: ignore[no-untyped-def]
    """Copy a part of each window, from its (row, col) on, to `edge`; outside of the field are zeros."""
    rows, cols = field.shape
    for n in range(len(corners)):
        for b in range(ROWS):
            for a in range(LANES):
                j, i = corners[n, 0] + row + b, corners[n, 1] + col + a
                inside = 0 <= j < rows and 0 <= i < cols
                edge[(n * ROWS + b) * LANES + a] = field[j, i] if inside else np.float32(0.0)
