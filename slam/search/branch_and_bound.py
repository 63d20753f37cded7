"""Exact search of the pose where scan points score best on a grid (Olson 2009; Hess et al. 2016, section V).

All poses of a window are candidates: headings at a fixed step, translations at the grid's cells. Blocks of
translations are bounded from above by a pyramid of maxima, and those that cannot win are never opened, so the answer is
that of the exhaustive search (`exhaustive.py`), to the bit.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..bounds import Reach, Step, check_numbers
from ..errors import InputError
from ..geometry import wrap_angle
from .best_first import best_leaves
from .kernels import rotated_cells, top_bounds
from .score_pyramid import ScorePyramid

_MOST_BLOCKS = 50_000_000  # of a window, four bytes each: a building of 400 m x 400 m, from blocks of 0.2 m
_MOST_HALF = 20_000  # cells: squares of distances stay below `best_first._RANKS`
_MOST_INDEX = 2**30  # cells: sums of two stay whole numbers of 32 bits


@dataclass(frozen=True, kw_only=True)
class SearchWindow:
    """The poses around the centre that are tried.

    Attributes:
        linear: Half the side of the square of translations [m].
        angular: Half the range of headings [rad]; pi or more is the full circle.
        angular_step: Step between headings [rad]; on the full circle it is shrunk to divide it evenly.
    """

    linear: Reach
    angular: float
    angular_step: Step

    def __post_init__(self) -> None:
        check_numbers(self)
        if not (self.linear >= 0.0 and self.angular >= 0.0 and self.angular_step > 0.0):
            raise InputError(
                "need `linear` >= 0 [m], `angular` >= 0 and `angular_step` > 0 [rad], got "
                f"{self.linear}, {self.angular} and {self.angular_step}"
            )

    def headings(self, centre: float) -> NDArray[np.float64]:
        """Return (n,) the headings that are tried [rad], `centre` among them at n // 2."""
        if self.angular >= np.pi:
            count = int(np.ceil(2.0 * np.pi / self.angular_step))
            steps, step = np.arange(count, dtype=np.float64) - count // 2, 2.0 * np.pi / count
        else:
            reach = int(np.floor(self.angular / self.angular_step + 1e-9))
            steps, step = np.arange(-reach, reach + 1, dtype=np.float64), self.angular_step
        return np.asarray(centre + steps * step, dtype=np.float64)

    def reach(self, resolution: float) -> int:
        """Return how many cells of that side [m] the window goes to each side of its centre."""
        return int(np.floor(self.linear / resolution + 1e-9))


@dataclass(frozen=True)
class Maximum:
    """One best pose.

    Attributes:
        pose: (x, y, theta) of the scan in the grid's frame [m, m, rad].
        score: Mean worth of the scan's points there, in [0, 1].
    """

    pose: tuple[float, float, float]
    score: float


@dataclass(frozen=True)
class SearchResult:
    """What a search found.

    Attributes:
        maxima: Best first; empty where no candidate reaches the least score.
        candidates: How many poses the window holds.
        looked_at: How many blocks and poses were scored to find the answer.
    """

    maxima: tuple[Maximum, ...]
    candidates: int
    looked_at: int

    @property
    def best(self) -> Maximum | None:
        """The best pose of the window; None: no candidate reaches the least score."""
        return self.maxima[0] if self.maxima else None


@dataclass(frozen=True, kw_only=True)
class Separation:
    """When a further maximum counts: further than this from the others in x, y or heading, and not much worse.

    Attributes:
        linear: [m].
        angular: [rad].
        least_share: Least score, as a share of the first maximum's; a high share makes the search faster.
    """

    linear: Reach = 0.5
    angular: float = 0.35
    least_share: float = 0.0

    def reach(self, headings: NDArray[np.float64], resolution: float) -> NDArray[np.int64]:
        """Return (2,) the same in steps between `headings` [rad] and in cells of side `resolution` [m]."""
        step = headings[1] - headings[0] if len(headings) > 1 else np.inf
        return np.array([self.angular / step, self.linear / resolution]).astype(np.int64)


def branch_and_bound(
    pyramid: ScorePyramid,
    points: ArrayLike,
    centre: ArrayLike,
    window: SearchWindow,
    *,
    min_score: float = 0.0,
    maxima: int = 1,
    separation: Separation | None = None,
) -> SearchResult:
    """Return the pose of the window at which `points` score highest, and further maxima if asked for.

    Exact and deterministic: of poses with equal score the one nearest to the centre wins (in steps: cells and
    headings), then the lowest heading, y, x. Each further maximum is the best pose apart from those before it.
    A least score makes the search faster: blocks below it are never opened.

    Args:
        pyramid: The scores, from `build_pyramid`.
        points: (N, 2) finite points of the scan in its own frame [m].
        centre: (3,) centre of the window, pose of the scan in the grid's frame [m, m, rad].
        window: What is searched.
        min_score: Least mean worth of a point, in [0, 1], that is still found.
        maxima: How many maxima to look for.
        separation: How far apart they must be; None: `Separation()`.

    Raises:
        InputError: If the window has more blocks than `_MOST_BLOCKS`, or a point is farther off than 2^31 cells.
    """
    separation = separation or Separation()
    points_scan = np.ascontiguousarray(points, dtype=np.float64)
    x, y, theta = np.asarray(centre, dtype=np.float64).tolist()
    headings = window.headings(theta)
    half = window.reach(pyramid.resolution)
    candidates = len(headings) * (2 * half + 1) ** 2
    _check_window(pyramid, points_scan, (x, y), len(headings), half)
    cells, bounds = _bounds(pyramid, points_scan, (x, y), headings, half)
    period = len(headings) if window.angular >= np.pi else 0
    reach = separation.reach(headings, pyramid.resolution)
    worth = 255.0 * max(len(points_scan), 1)
    least = np.int64(np.ceil(min_score * worth - 1e-6))
    if len(points_scan) == 0:
        return SearchResult((), candidates, 0)
    share = separation.least_share
    leaves, looked = best_leaves(pyramid.levels, cells, bounds, 2 * half + 1, maxima, reach, period, least, share)
    h, angles = pyramid.resolution, wrap_angle(headings)
    found = [
        Maximum((x + (j - half) * h, y + (i - half) * h, float(angles[k])), total / worth)
        for total, k, i, j in leaves.tolist()
    ]
    return SearchResult(tuple(found), candidates, int(looked))


def _check_window(
    pyramid: ScorePyramid, points: NDArray[np.float64], centre: tuple[float, float], headings: int, half: int
) -> None:
    """Raise InputError where a search would have no end, or its whole numbers would overflow."""
    blocks = (2 * half >> (len(pyramid.levels) - 1)) + 1
    if headings * blocks**2 > _MOST_BLOCKS or half > _MOST_HALF:
        raise InputError(
            f"the search window has {headings} headings x {blocks} x {blocks} blocks, more than {_MOST_BLOCKS}; it is "
            "too large, or its steps are too small"
        )
    places = np.abs(np.subtract(centre, pyramid.origin)).max() + np.abs(points).max(initial=0.0)
    if not places / pyramid.resolution < _MOST_INDEX:
        raise InputError(f"a search must lie within {_MOST_INDEX} cells of its map, got {places / pyramid.resolution}")


def _bounds(
    pyramid: ScorePyramid, points: NDArray[np.float64], centre: tuple[float, float], headings: NDArray, half: int
) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Return the points' cells at each heading, at the window's lowest corner, and the bounds of all top blocks."""
    cells = np.empty((len(headings), len(points), 2), dtype=np.int32)
    x, y = centre[0] - pyramid.origin[0], centre[1] - pyramid.origin[1]
    rotated_cells(points, headings, x, y, pyramid.resolution, pyramid.border - half, cells)
    stride = 1 << (len(pyramid.levels) - 1)
    return cells, top_bounds(pyramid.phases, pyramid.skirt, pyramid.border, cells, -(-(2 * half + 1) // stride))
