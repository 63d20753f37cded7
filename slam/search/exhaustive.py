"""The search that tries every pose: slow, plain numpy, what the branch and bound must equal."""

import numpy as np
from numpy.typing import ArrayLike

from ..geometry import wrap_angle
from .branch_and_bound import Maximum, SearchResult, SearchWindow
from .score_pyramid import ScoreGrid


def exhaustive_search(
    grid: ScoreGrid, points: ArrayLike, centre: ArrayLike, window: SearchWindow, *, min_score: float = 0.0
) -> SearchResult:
    """Return what `branch_and_bound` with one maximum returns, by scoring every pose of the window."""
    points_scan = np.asarray(points, dtype=np.float64)
    x, y, theta = np.asarray(centre, dtype=np.float64)
    headings = window.headings(theta)
    reach = window.reach(grid.resolution)
    side = 2 * reach + 1
    candidates = len(headings) * side * side
    best: tuple[int, int, int, int, int] | None = None
    steps = np.arange(-reach, reach + 1)
    for k, heading in enumerate(headings):
        totals = scores_at(grid, points_scan, x, y, heading, steps)
        rank = (k - len(headings) // 2) ** 2 + steps[:, None] ** 2 + steps[None, :] ** 2
        tied = np.argwhere(totals == totals.max())
        row, col = min(tied.tolist(), key=lambda cell: (rank[cell[0], cell[1]], cell[0], cell[1]))
        entry = (-int(totals[row, col]), int(rank[row, col]), k, row, col)
        best = entry if best is None else min(best, entry)
    worth = 255.0 * len(points_scan)
    if best is None or len(points_scan) == 0 or -best[0] < np.ceil(min_score * worth - 1e-6):
        return SearchResult((), candidates, candidates)
    _, _, k, row, col = best
    pose = (
        float(x + steps[col] * grid.resolution),
        float(y + steps[row] * grid.resolution),
        float(wrap_angle(headings[k])),
    )
    return SearchResult((Maximum(pose, float(-best[0] / worth)),), candidates, candidates)


def scores_at(grid: ScoreGrid, points: np.ndarray, x: float, y: float, heading: float, steps: np.ndarray) -> np.ndarray:
    """Return (side, side) int64 sums over the points, by row and column offset."""
    cos, sin = np.cos(heading), np.sin(heading)
    corner_x, corner_y = x - grid.origin[0], y - grid.origin[1]
    col = np.floor((cos * points[:, 0] - sin * points[:, 1] + corner_x) / grid.resolution).astype(np.int64)
    row = np.floor((sin * points[:, 0] + cos * points[:, 1] + corner_y) / grid.resolution).astype(np.int64)
    rows, cols = grid.values.shape
    row, col = row[:, None, None] + steps[None, :, None], col[:, None, None] + steps[None, None, :]
    inside = (row >= 0) & (row < rows) & (col >= 0) & (col < cols)
    worth = grid.values[np.clip(row, 0, rows - 1), np.clip(col, 0, cols - 1)].astype(np.int64)
    return np.where(inside, worth, 0).sum(axis=0)
