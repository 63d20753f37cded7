"""Where a map, or a part of one, may lie in another map: all places and headings, searched exactly."""

import numpy as np
from numpy.typing import NDArray

from ..geometry import compose, inverse
from ..search.branch_and_bound import SearchWindow, Separation, branch_and_bound
from ..search.score_pyramid import ScoreGrid, ScorePyramid, build_pyramid
from .icp import Cloud

Array = NDArray[np.float64]

_POINTS = 300  # of the smaller map
_CELL = 0.2  # [m] at least; of the larger map's extent one of `_MOST_CELLS`
_MOST_CELLS = 200
_TOP_LEVEL = 3
_MAXIMA, _SEPARATION = 6, Separation(linear=1.0, angular=0.2)
_OUTSIDE = 0.25  # share of its own radius that the middle of the smaller map may lie beyond the larger one


def placements(est: Cloud, ref: Cloud) -> list[Array]:
    """Return the poses T_ref_est (3,) at which most of the smaller map lies on the larger one, to a cell."""
    if _extent(est) > _extent(ref):
        return [inverse(T_est_ref) for T_est_ref in placements(ref, est)]
    part = est.sample(_POINTS)
    middle = part.mean(axis=0)
    radius = float(np.hypot(*(part - middle).T).max())
    low, high = ref.points.min(axis=0), ref.points.max(axis=0)
    cell = max(_CELL, _extent(ref) / _MOST_CELLS)
    window = SearchWindow(
        linear=0.5 * _extent(ref) + _OUTSIDE * radius, angular=np.pi, angular_step=cell / max(radius, cell)
    )
    pyramid = _likelihood(ref, low, high, cell, window.reach(cell))
    found = branch_and_bound(
        pyramid, part - middle, (*(0.5 * (low + high)), 0.0), window, maxima=_MAXIMA, separation=_SEPARATION
    )
    return [compose(maximum.pose, (*-middle, 0.0)) for maximum in found.maxima]


def _extent(cloud: Cloud) -> float:
    return float(np.ptp(cloud.points, axis=0).max())


def _likelihood(ref: Cloud, low: Array, high: Array, cell: float, reach: int) -> ScorePyramid:
    """Return what a point is worth at each place: 1 on an occupied cell of the map, less beside it."""
    low, high = low - 4.0 * cell, high + 4.0 * cell
    cols, rows = np.ceil((high - low) / cell).astype(int)
    x, y = np.meshgrid(low[0] + (np.arange(cols) + 0.5) * cell, low[1] + (np.arange(rows) + 0.5) * cell)
    distances, _ = ref.nearest.query(np.stack((x.ravel(), y.ravel()), axis=-1))
    likelihood = np.exp(-0.5 * (distances / cell) ** 2).reshape(x.shape)
    grid = ScoreGrid.from_likelihood(likelihood, (float(low[0]), float(low[1])), cell)
    return build_pyramid(grid, top_level=_TOP_LEVEL, margin=reach + (1 << _TOP_LEVEL))
