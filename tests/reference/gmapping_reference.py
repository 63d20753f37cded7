"""The kernels of GMapping once more, in plain numpy on one grid without tiles: what the tests compare them with.

Lengths are in cells. Grids are (rows, cols), row 0 at y = 0.
"""

import numpy as np
from numpy.typing import NDArray
from tagalong.slam.gmapping.fit_kernels import NEAR
from tagalong.slam.gmapping.tile_kernels import SIDE
from tagalong.slam.rays import ray_cells

Array = NDArray[np.float64]


def count_rays(
    x0: float, y0: float, ends: Array, is_hit: NDArray[np.bool_], shape: tuple[int, int], margin: float = 0.0
) -> tuple[NDArray[np.int64], Array]:
    """Return counts (rows, cols, 2) of hits and visits, and the sums (rows, cols, 2) of hit points from the corner of
    their cells, of rays from (x0, y0) to `ends` (n, 2); the last share `margin` of those that hit visits nothing."""
    counts, sums = np.zeros((*shape, 2), dtype=np.int64), np.zeros((*shape, 2))
    for end, hit in zip(ends, is_hit, strict=True):
        share = 1.0 - margin if hit else 1.0
        cells = ray_cells(x0, y0, x0 + share * (end[0] - x0), y0 + share * (end[1] - y0))
        rows, cols = cells[:-1].T
        counts[rows, cols, 1] += 1
        if hit:
            col, row = np.floor(end).astype(int)
            counts[row, col] += 1
            sums[row, col] += end - (col, row)
    return counts, sums


def normal_equations(
    pose: Array,
    points: Array,
    half: int,
    scale: float,
    straightness: float,
    centres: Array,
    hits: Array,
    free: NDArray[np.bool_],
) -> tuple[Array, float]:
    """Return what `match_kernels.accumulate` does: (3, 4) weighted [H | g] and the mean loss.

    Args:
        pose: (3,) x, y, theta.
        points: (n, 2) of the scan.
        half: Half size of the window.
        scale: Distance at which a point counts a quarter.
        straightness: Largest ratio of the variances across and along a line.
        centres: (m, 2) x, y mean hit points of the occupied cells.
        hits: (m,) how many points each is the mean of: its weight in a line.
        free: (rows, cols) where rays have been, and nothing is.
    """
    system, losses = np.zeros((3, 4)), []
    cells = np.floor(centres)
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    for arm in points @ np.array([[cos, sin], [-sin, cos]]):
        point = pose[:2] + arm
        seen = np.flatnonzero(np.abs(cells - np.floor(point)).max(axis=1) <= half)
        if not len(seen):
            losses.append(1.0)
            continue
        nearest = seen[np.argmin(np.sum((centres[seen] - point) ** 2, axis=1))]
        apart = np.abs(cells - cells[nearest]).max(axis=1)
        beside = apart <= (2 if np.count_nonzero(apart <= 2) >= 3 else 5)
        around, weights = centres[beside], hits[beside]
        jacobian = np.array([[1.0, 0.0, -arm[1]], [0.0, 1.0, arm[0]]])
        residual = point - centres[nearest]
        variances, axes = np.ones(2), np.eye(2)
        if len(around) >= 3:
            variances, axes = np.linalg.eigh(np.cov(around.T, bias=True, aweights=weights))
        if variances[0] <= straightness * variances[1]:
            normal, middle = axes[:, :1].T, np.average(around, axis=0, weights=weights)
            towards = np.sign(normal @ (pose[:2] - middle)) * normal[0]
            before, behind = (free[int(y), int(x)] for x, y in (middle + 2.0 * towards, middle - 2.0 * towards))
            if behind and not before:
                losses.append(1.0)
                continue
            residual, jacobian = normal @ (point - middle), normal @ jacobian
        error = residual @ residual / scale**2
        system += jacobian.T @ np.column_stack((jacobian, residual)) / (1.0 + error) ** 2
        losses.append(error / (1.0 + error))
    return system, float(np.mean(losses))


def sample_values(
    prior: Array,
    root: Array,
    samples: Array,
    points: Array,
    weight: float,
    unseen: float,
    visited: NDArray[np.bool_],
    occupied: NDArray[np.bool_],
) -> tuple[Array, Array]:
    """Return the poses (m, 3) among which `fit_kernels.search_samples` chooses, and the value (m,) of each."""
    poses = prior + samples @ root.T
    against = [spoken_against(pose, points, unseen, visited, occupied)[0] for pose in poses]
    return poses, -weight * np.array(against) / len(points) - 0.5 * np.sum(samples**2, axis=1)


def spoken_against(
    pose: Array, points: Array, unseen: float, visited: NDArray[np.bool_], occupied: NDArray[np.bool_]
) -> tuple[float, int]:
    """Return what `fit_kernels.compare` does."""
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    against, unknown = 0.0, 0
    for px, py in points:
        col, row = int(np.floor(pose[0] + cos * px - sin * py)), int(np.floor(pose[1] + sin * px + cos * py))
        inside = 0 <= row < occupied.shape[0] and 0 <= col < occupied.shape[1]
        corner = np.array([row, col]) // SIDE * SIDE
        near = np.argwhere(occupied) if inside else np.zeros((0, 2), dtype=int)
        near = near[(near // SIDE * SIDE == corner).all(axis=1)]
        distance = np.abs(near - [row, col]).max(axis=1).min(initial=NEAR + 1)
        if distance <= 1:
            continue
        if distance <= NEAR:
            against += 0.5
        elif inside and visited[row, col]:
            against += 1.0
        else:
            against, unknown = against + unseen, unknown + 1
    return against, unknown


def score_table(side: int, unknown: int, near: int, visited: NDArray[np.bool_], occupied: NDArray[np.bool_]) -> Array:
    """Return what `fit_kernels.draw_scores` draws of a whole map."""
    rows, cols = np.array(occupied.shape) // side
    hit = occupied.reshape(rows, side, cols, side).any(axis=(1, 3))
    seen = visited.reshape(rows, side, cols, side).any(axis=(1, 3))
    values = np.where(hit, 255, np.where(seen, 0, unknown))
    for row, col in np.argwhere(hit[1:-1, 1:-1]) + 1:
        block = values[row - 1 : row + 2, col - 1 : col + 2]
        np.maximum(block, near, out=block)
    return values
