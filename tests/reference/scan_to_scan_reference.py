"""The plain numpy twins of the kernels of scan-to-scan matching."""

import numpy as np
from numpy.typing import NDArray
from tagalong.slam.geometry import transform_points
from tagalong.slam.search.score_pyramid import ScoreGrid


def nearest_point_reference(
    x: float, y: float, k: float, points: NDArray[np.float64], limit: float
) -> tuple[int, float]:
    """Return what `nearest_point` returns, by looking at all `points` (M, 2)."""
    if len(points) == 0:
        return -1, limit
    difference = points - [x, y]
    cross = x * difference[:, 1] - y * difference[:, 0]
    square = (difference**2).sum(axis=1) - (1.0 - k) * cross**2 / max(x * x + y * y, 1e-12)
    index = int(np.argmin(square))
    return (index, float(square[index])) if square[index] < limit else (-1, limit)


def lookup_fitness_reference(
    poses: NDArray[np.float64], points: NDArray[np.float64], grid: ScoreGrid
) -> NDArray[np.float64]:
    """Return (P,) what `lookup_fitness` writes."""
    moved = (transform_points(poses, np.broadcast_to(points, (len(poses), *points.shape))) - grid.origin) / (
        grid.resolution
    )
    col, row = np.floor(moved[..., 0]).astype(int), np.floor(moved[..., 1]).astype(int)
    rows, cols = grid.values.shape
    inside = (row >= 0) & (row < rows) & (col >= 0) & (col < cols)
    worth = grid.values[np.clip(row, 0, rows - 1), np.clip(col, 0, cols - 1)]
    return np.where(inside, worth, 0).mean(axis=-1) / 255.0


def polar_fitness_reference(
    poses: NDArray[np.float64],
    points: NDArray[np.float64],
    ranges: NDArray[np.float64],
    start: float,
    step: float,
    threshold: float,
) -> NDArray[np.float64]:
    """Return (P,) what `polar_fitness` writes."""
    moved = transform_points(poses, np.broadcast_to(points, (len(poses), *points.shape)))
    bearing = np.arctan2(moved[..., 1], moved[..., 0])
    beam = np.floor(((bearing - start) / step) % (2.0 * np.pi / step) + 0.5).astype(int)
    known = np.append(ranges, np.nan)[np.minimum(beam, len(ranges))]
    error = np.abs(np.hypot(moved[..., 0], moved[..., 1]) - known)
    return np.where(error < threshold, 1.0 - error / threshold, 0.0).mean(axis=-1)


def mark_unseen_reference(
    points: NDArray[np.float64], x0: float, y0: float, cell: float, margin: float, worth: int, values: NDArray[np.uint8]
) -> None:
    """Do what `mark_unseen` does, by looking at the bearings of all `points` (M, 2) from each cell's centre."""
    bearings, ranges = np.arctan2(points[:, 1], points[:, 0]), np.hypot(points[:, 0], points[:, 1])
    for row, col in np.ndindex(values.shape):
        x, y = x0 + (col + 0.5) * cell, y0 + (row + 0.5) * cell
        apart = (bearings - np.arctan2(y, x)) % (2.0 * np.pi)
        sides = [np.argmin(np.where(apart > 0.0, apart, 7.0)), np.argmax(apart)]
        ahead = [ranges[k] for k in sides if min(apart[k], 2.0 * np.pi - apart[k]) < np.arcsin(0.087)]
        if not ahead or min(ahead) <= np.hypot(x, y) + margin:
            values[row, col] = max(values[row, col], worth)


def log_evidence_reference(
    points: NDArray[np.float64],
    apart: NDArray[np.bool_],
    noise: float,
    costs: tuple[float, float, float],
    longest: int,
) -> float:
    """Return what `log_evidence` returns first, by singular values."""
    logs = np.full(len(points) + 1, -np.inf)
    logs[0] = 0.0
    for end in range(1, len(points) + 1):
        for start in range(max(0, end - longest), end):
            piece = points[start:end]
            if not apart[start : end - 1].any():
                least = np.linalg.svd(piece - piece.mean(axis=0), compute_uv=False)[-1] if len(piece) > 2 else 0.0
                cost = costs[min(len(piece), 3) - 1] + 0.5 * (least / noise) ** 2
                logs[end] = np.logaddexp(logs[end], logs[start] - cost)
    return float(logs[-1])
