"""Ways through a floor: short, in the middle of doors, round rather than angular."""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .cells import FreeSpace, regions
from .polyline import resample
from .way_kernel import buckets_for, explore, nearest, smooth, traced

Array = NDArray[np.float64]

STEP = 0.1
"""Distance of the points of a way [m]."""
_COMFORT = 1.0
_SMOOTHING = 80
_REMEMBERED = 40


@dataclass(frozen=True, eq=False)
class Way:
    """A planned way.

    Attributes:
        points: (n, 2), `STEP` apart [m].
        stops: (k,) way along it [m] at which it passes the places it was planned through.
    """

    points: Array
    stops: Array

    @property
    def length(self) -> float:
        """Length [m]."""
        return (len(self.points) - 1) * STEP


class WaySearch:
    """Dijkstra's search from one cell, carried only as far as it is asked for.

    Args:
        cost: (rows, cols) price of a cell, at least 1; inf cannot be entered.
        row: Of the start.
        col: Of the start.
        buckets: `buckets_for` of the cost, where it is known.

    Attributes:
        price: (rows, cols) price of the cheapest way to each cell that is settled.
        before: (rows, cols) flat index of the cell before on it, -1 at the start.
    """

    def __init__(self, cost: Array, row: int, col: int, buckets: int | None = None) -> None:
        self._cost = cost
        self.price, self.before = np.full(cost.shape, np.inf), np.full(cost.shape, -1, dtype=np.int64)
        self._settled = np.zeros(cost.shape, dtype=bool)
        self._links = np.full((2, cost.size), -1, dtype=np.int32)
        self._heads = np.full(buckets_for(cost) if buckets is None else buckets, -1, dtype=np.int32)
        self.price[row, col] = 0.0
        self._heads[0] = row * cost.shape[1] + col
        self._bucket = 0

    def settle(self, goal: int = -1, limit: float = np.inf) -> None:
        """Settle the cell of the flat index `goal`, or all cells up to the price `limit`."""
        state = self.price, self.before, self._settled, self._links, self._heads, self._bucket
        self._bucket = explore(self._cost, *state, goal, limit)


class WayPlanner:
    """Plans ways that keep `clearance` from everything.

    Args:
        space: The floor.
        clearance: Least distance of a way from what is not free [m].
    """

    def __init__(self, space: FreeSpace, clearance: float) -> None:
        self.space, self.clearance = space, clearance
        every = max(1, round(STEP / space.resolution))
        self._coarse = space.clearance[::every, ::every]
        offset = 0.5 * space.resolution
        self._side = every * space.resolution
        self._origin = np.asarray(space.origin) + offset
        self._corner = (float(self._origin[0]), float(self._origin[1]))
        narrow = np.clip((_COMFORT - self._coarse) / _COMFORT, 0.0, 1.0)
        self._cost = np.where(self._coarse >= clearance, 1.0 + 3.0 * narrow**2, np.inf)
        self._buckets = buckets_for(self._cost)
        self._searches: dict[tuple[int, int], WaySearch] = {}

    @cached_property
    def regions(self) -> NDArray[np.int64]:
        """(rows, cols) number of the connected region of each coarse cell, 0 where no way can be."""
        return regions(np.isfinite(self._cost))

    @cached_property
    def places(self) -> Array:
        """(k, 2) all places [m] in the largest connected region."""
        sizes = np.bincount(self.regions.ravel())
        sizes[0] = 0
        rows, cols = np.nonzero(self.regions == int(sizes.argmax())) if sizes.any() else (np.zeros(0), np.zeros(0))
        return np.stack((cols, rows), axis=-1) * self._side + self._origin

    @cached_property
    def _place_cells(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        return self._cells(self.places)

    @property
    def area(self) -> float:
        """Area of the largest connected region [m^2]."""
        return len(self.places) * self._side**2

    def nearest(self, point: ArrayLike) -> Array | None:
        """Return the place (2,) [m] nearest to `point` (2,); None where nothing is free."""
        if len(self.places) == 0:
            return None
        x, y = np.asarray(point, dtype=np.float64).tolist()
        return self.places[nearest(self.places, x, y)]

    def distances(self, start: ArrayLike, within: float = np.inf) -> Array:
        """Return (k,) the price of the way from `start` (2,) to each of `places`; about metres where there is room.

        Those dearer than `within` are some number above it.
        """
        search = self._search(start)
        search.settle(limit=1.001 * within / self._side)
        return search.price[self._place_cells] * self._side

    def way(self, through: ArrayLike) -> Way | None:
        """Return the way through the places `through` (m, 2) in order [m]; None if one cannot be reached."""
        places = np.asarray(through, dtype=np.float64)
        legs = [self._leg(start, goal) for start, goal in pairwise(places)]
        joined = [leg for leg in legs if leg is not None and len(leg) > 1]
        if len(joined) < len(legs) or not joined:
            return None
        rough = np.concatenate([joined[0], *(leg[1:] for leg in joined[1:])])
        space = self.space
        smoothed = smooth(rough, space.clearance, *space.origin, space.resolution, self.clearance, _SMOOTHING)
        points = resample(smoothed, STEP)
        away = np.hypot(*(points[:, None] - places[None]).transpose(2, 0, 1))
        return Way(points, away.argmin(axis=0) * STEP) if len(points) > 2 else None

    def _cells(self, points: ArrayLike) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        cells = np.rint((np.asarray(points, dtype=np.float64) - self._origin) / self._side).astype(np.int64)
        rows, cols = self._cost.shape
        return np.clip(cells[..., 1], 0, rows - 1), np.clip(cells[..., 0], 0, cols - 1)

    def _cell(self, point: ArrayLike) -> tuple[int, int]:
        """Return row and column of one point, as `_cells`."""
        x, y = np.asarray(point, dtype=np.float64).tolist()
        rows, cols = self._cost.shape
        col, row = round((x - self._corner[0]) / self._side), round((y - self._corner[1]) / self._side)
        return min(max(row, 0), rows - 1), min(max(col, 0), cols - 1)

    def _search(self, start: ArrayLike) -> WaySearch:
        row, col = self._cell(start)
        if len(self._searches) > _REMEMBERED:
            self._searches.clear()
        if (row, col) not in self._searches:
            self._searches[row, col] = WaySearch(self._cost, row, col, self._buckets)
        return self._searches[row, col]

    def _leg(self, start: Array, goal: Array) -> Array | None:
        """Return (n, 2) the cheapest way, cell by cell."""
        search = self._search(start)
        row, col = self._cell(goal)
        width = self._cost.shape[1]
        flat = row * width + col
        search.settle(goal=flat)
        if not np.isfinite(search.price[row, col]):
            return None
        return traced(search.before, flat, *self._corner, self._side)


def folds(points: Array, apart: float = 0.8) -> bool:
    """Return whether a way (n, 2) turns on the spot: comes within `apart` [m] of where it was 2 to 3.5 m before.

    A robot that follows 1.3 m behind would meet its leader there.
    """
    for steps in (round(2.0 / STEP), round(2.75 / STEP), round(3.5 / STEP)):
        if len(points) > steps and np.hypot(*(points[steps:] - points[:-steps]).T).min() < apart:
            return True
    return False
