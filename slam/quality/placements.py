"""Where a map, or a part of one, may lie in another map: all places and headings, searched exactly."""

import numpy as np
from numpy.typing import NDArray

from ..geometry import compose
from ..search.branch_and_bound import SearchWindow, Separation, branch_and_bound
from ..search.score_pyramid import ScoreGrid, ScorePyramid, build_pyramid
from .icp import Cloud

Array = NDArray[np.float64]

_POINTS = 300  # of the smaller map
_CELL = 0.2  # [m] at least ...
_MOST_CELLS = 2000  # ... and so large that the larger map has no more of them a side ...
_MOST_BLOCKS = 4_000_000  # ... and the search begins with no more blocks than these
_TOP_LEVEL = 3  # of blocks, of 2^3 cells a side
_MAXIMA, _SEPARATION = 6, Separation(linear=1.0, angular=0.2)
_LEAST = 0.5  # share of the smaller map that must lie on the larger one: what has less in common takes long to search
_OUTSIDE = 0.25  # share of its own radius that the middle of the smaller map may lie beyond the larger one


def placements(part: Cloud, whole: Cloud) -> list[Array]:
    """Return the poses T_whole_part (3,) at which most of the smaller map lies on the larger one, to a cell."""
    points = part.sample(_POINTS)
    middle = points.mean(axis=0)
    radius = float(np.hypot(*(points - middle).T).max())
    low, high = whole.points.min(axis=0), whole.points.max(axis=0)
    linear = 0.5 * whole.extent + _OUTSIDE * radius
    side = 2.0 * linear / (1 << _TOP_LEVEL)
    by_blocks = float(np.cbrt(2.0 * np.pi * radius * side**2 / _MOST_BLOCKS))
    cell = max(_CELL, whole.extent / _MOST_CELLS, by_blocks)
    window = SearchWindow(linear=linear, angular=np.pi, angular_step=cell / max(radius, cell))
    pyramid = _likelihood(whole, low, high, cell, window.reach(cell))
    found = branch_and_bound(
        pyramid, points - middle, (*(0.5 * (low + high)), 0.0), window,
        min_score=_LEAST, maxima=_MAXIMA, separation=_SEPARATION,
    )  # fmt: skip
    return [compose(maximum.pose, (*-middle, 0.0)) for maximum in found.maxima]


def _likelihood(whole: Cloud, low: Array, high: Array, cell: float, reach: int) -> ScorePyramid:
    """Return what a point is worth at each place: 1 on an occupied cell of the map, less beside it."""
    low, high = low - 4.0 * cell, high + 4.0 * cell
    cols, rows = np.ceil((high - low) / cell).astype(int)
    x, y = np.meshgrid(low[0] + (np.arange(cols) + 0.5) * cell, low[1] + (np.arange(rows) + 0.5) * cell)
    distances, _ = whole.nearest.query(np.stack((x.ravel(), y.ravel()), axis=-1))
    likelihood = np.exp(-0.5 * (distances / cell) ** 2).reshape(x.shape)
    grid = ScoreGrid.from_likelihood(likelihood, (float(low[0]), float(low[1])), cell)
    return build_pyramid(grid, top_level=_TOP_LEVEL, margin=reach + (1 << _TOP_LEVEL))
