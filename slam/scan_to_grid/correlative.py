"""Real-time correlative search: every pose of a small window is scored (Olson 2009)."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]


@njit(cache=True, nogil=True)
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
    rows, cols = field.shape
    side = 2 * reach + 1
    scores, flat = np.empty(side * side, np.float32), field.ravel()
    best, best_pose, best_rest = np.inf, prior.copy(), float(len(points))
    P = prior_information
    for k in range(-angles, angles + 1):
        dt = k * angle_step
        c, s = np.cos(prior[2] + dt), np.sin(prior[2] + dt)
        scores[:] = 0.0
        for n in range(len(points)):
            x = prior[0] + c * points[n, 0] - s * points[n, 1] - corner[0]
            y = prior[1] + s * points[n, 0] + c * points[n, 1] - corner[1]
            i, j = int(np.floor(x / resolution + 0.5)) - reach, int(np.floor(y / resolution + 0.5)) - reach
            first, last = max(0, -i), min(side, cols - i)
            if first >= last:
                continue
            for b in range(max(0, -j), min(side, rows - j)):
                to, at = np.uintp(b * side + first), np.uintp((j + b) * cols + i + first)
                for a in range(np.uintp(last - first)):  # unsigned and without slices: half as long again with them
                    scores[to + a] += min(np.float32(1.0), np.float32(1.7) * flat[at + a])
        for b in range(side):
            dy = (b - reach) * resolution
            for a in range(side):
                dx = (a - reach) * resolution
                rest = len(points) - scores[b * side + a]
                pull = P[0, 0] * dx * dx + P[1, 1] * dy * dy + P[2, 2] * dt * dt
                pull += 2.0 * (P[0, 1] * dx * dy + P[0, 2] * dx * dt + P[1, 2] * dy * dt)
                total = weight * rest + 0.5 * pull
                if total < best:
                    best, best_rest = total, rest
                    best_pose[0], best_pose[1], best_pose[2] = prior[0] + dx, prior[1] + dy, prior[2] + dt
    return best_pose, best_rest
