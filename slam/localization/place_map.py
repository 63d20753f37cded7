"""A finished map, made ready: a field to match scans on, distances and states to judge them by, a pyramid to search."""

from dataclasses import dataclass
from functools import cached_property
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

from ..bounds import Cell, Share, Within, check_numbers, check_positive
from ..errors import InputError
from ..geometry import wrap_angle
from ..occupancy_map import OccupancyMap
from ..search.score_pyramid import ScoreGrid, ScorePyramid, build_pyramid
from .beam_fit_kernels import FREE, OCCUPIED, UNKNOWN

Array = NDArray[np.float64]

_LEAST_WALL_CELLS = 20
_POSES = 256
_GOLDEN = np.pi * (3.0 - np.sqrt(5.0))  # [rad] multiples of this angle are spread evenly, however many there are


@dataclass(frozen=True, kw_only=True)
class PlaceMapConfig:
    """Settings of `PlaceMap`.

    Attributes:
        resolution: Side of the cells for matching [m]; finer maps are made coarser, coarser ones stay.
        search_resolution: Side of the cells of the global search [m], likewise.
        wall_sigma: Width of a wall on the field that scans are matched on [m].
        search_sigma: Width of a wall on the grid of the global search [m].
        unseen: Worth of a point where the map knows nothing, in the global search: places at its edge are found, too.
        unseen_margin: So far around the map, too [m].
        top_level: The global search starts from blocks of 2^top_level cells, so that most of it is one sweep ...
        most_blocks: ... or from larger ones, where there would be more than so many for each heading: memory.
    """

    resolution: Cell = 0.05
    search_resolution: Cell = 0.1
    wall_sigma: Annotated[float, Within(1e-3, 100.0)] = 0.05
    search_sigma: Annotated[float, Within(1e-3, 100.0)] = 0.15
    unseen: Share = 0.4
    unseen_margin: Annotated[float, Within(0.0, 100.0)] = 8.0
    top_level: Annotated[int, Within(0, 8)] = 1
    most_blocks: Annotated[int, Within(1, 1_000_000)] = 100_000

    def __post_init__(self) -> None:
        check_numbers(self)
        check_positive(self)


class PlaceMap:
    """What localization needs of an occupancy map, cut to what is known and a margin.

    Args:
        grid: The map, of any resolution.
        config: Settings.

    Attributes:
        states: (rows, cols) uint8, UNKNOWN, FREE or OCCUPIED.
        distances: (rows, cols) float32, to the nearest occupied cell [m].
        field: (rows, cols) float32 in [0, 1], a wall's occupancy, smooth across it.
        resolution: Side of a cell [m].
        outer_corner: (2,) outer corner of cell [0, 0], map frame [m].

    Raises:
        InputError: If the map has hardly any wall or no free space.
    """

    def __init__(self, grid: OccupancyMap, config: PlaceMapConfig | None = None) -> None:
        self.config = config = config or PlaceMapConfig()
        occupied, free = grid.occupied, grid.free
        if occupied.sum() < _LEAST_WALL_CELLS or not free.any():
            raise InputError(
                f"a map to localize on needs walls ({_LEAST_WALL_CELLS} occupied cells) and free space, got "
                f"{occupied.sum()} occupied and {free.sum()} free cells"
            )
        factor = max(1, round(config.resolution / grid.resolution))
        self.resolution = grid.resolution * factor
        low, shape = _window(grid.known, factor)
        self.outer_corner = np.array(grid.origin, dtype=np.float64) + low[::-1] * grid.resolution
        occupied, free = _cut(occupied, low, shape), _cut(free, low, shape)
        self.states = np.zeros((shape[0] // factor, shape[1] // factor), np.uint8)
        self.states[_any(free, factor)] = FREE
        self.states[_any(occupied, factor)] = OCCUPIED
        fine = np.asarray(distance_transform_edt(~occupied), dtype=np.float64) * grid.resolution
        self.distances = _centres(fine, factor).astype(np.float32)
        sigma = max(config.wall_sigma, 0.7 * self.resolution)
        self.field = np.exp(-0.5 * (self.distances / sigma) ** 2).astype(np.float32)

    @property
    def corner(self) -> Array:
        """(2,) centre of cell [0, 0], map frame [m]."""
        return np.asarray(self.outer_corner + 0.5 * self.resolution, dtype=np.float64)

    @cached_property
    def coarse_field(self) -> NDArray[np.float32]:
        """(rows, cols) as `field`, with walls as wide as in the global search: catches poses from farther away."""
        sigma = max(self.config.search_sigma, self.resolution)
        return np.exp(-0.5 * (self.distances / sigma) ** 2).astype(np.float32)

    @cached_property
    def pyramid(self) -> ScorePyramid:
        """The scores of the global search."""
        factor = max(1, round(self.config.search_resolution / self.resolution))
        cell = factor * self.resolution
        sigma = max(self.config.search_sigma, cell)
        likelihood = np.exp(-0.5 * (_centres(self.distances, factor) / sigma) ** 2)
        unknown = _centres((self.states == UNKNOWN).astype(np.float64), factor) > 0.5
        likelihood[unknown] = np.maximum(likelihood[unknown], self.config.unseen)
        margin = int(self.config.unseen_margin / cell)
        likelihood = np.pad(likelihood, margin, constant_values=self.config.unseen)
        corner = (float(self.outer_corner[0] - margin * cell), float(self.outer_corner[1] - margin * cell))
        grid = ScoreGrid.from_likelihood(likelihood, corner, cell)
        half = self.half_side / cell
        return build_pyramid(grid, top_level=self._top_level(2.0 * half), margin=int(half) + 1)

    def _top_level(self, side: float) -> int:
        """Return the level that a search starts from, over a square of a side of so many cells."""
        level = self.config.top_level
        while (side / (1 << level)) ** 2 > self.config.most_blocks:
            level += 1
        return level

    @property
    def centre(self) -> Array:
        """(2,) middle of the map [m]."""
        return self.outer_corner + 0.5 * self.resolution * np.array(self.states.shape[::-1])

    @property
    def half_side(self) -> float:
        """Half the longer side of the map [m]."""
        return 0.5 * self.resolution * max(self.states.shape)

    @cached_property
    def free_area(self) -> float:
        """Where the robot may stand [m^2]."""
        return float((self.states == FREE).sum()) * self.resolution**2

    @cached_property
    def anywhere(self) -> Array:
        """(256, 3) poses spread over the free space and all headings."""
        rows, cols = np.nonzero(self.states == FREE)
        chosen = np.linspace(0, len(rows) - 1, _POSES).astype(np.int64)
        headings = wrap_angle(_GOLDEN * np.arange(_POSES))
        return np.column_stack((self.corner + self.resolution * np.stack((cols, rows), axis=-1)[chosen], headings))

    def to_free_space(self, place: Array) -> float:
        """Return the distance from a place (2,) to the nearest free cell's centre [m]."""
        rows, cols = np.nonzero(self.states == FREE)
        centres = self.corner + self.resolution * np.stack((cols, rows), axis=-1)
        return float(np.hypot(*(centres - place).T).min(initial=np.inf))

    @cached_property
    def _to_free(self) -> NDArray[np.float32]:
        """(rows, cols) from each cell's centre to the nearest free cell's centre [m]."""
        cells = np.asarray(distance_transform_edt(self.states != FREE), dtype=np.float32)
        return cells * np.float32(self.resolution)

    def is_open(self, places: Array, reach: float) -> NDArray[np.bool_]:
        """Return (k,) whether there is a free cell within `reach` [m] of the places (k, 2) [m]."""
        cells = np.floor((places - self.outer_corner) / self.resolution).astype(np.int64)
        rows, cols = self.states.shape
        x, y = cells[:, 0], cells[:, 1]
        inside = (x >= 0) & (y >= 0) & (x < cols) & (y < rows)
        return inside & (self._to_free[np.clip(y, 0, rows - 1), np.clip(x, 0, cols - 1)] <= reach)


def _window(known: NDArray[np.bool_], factor: int) -> tuple[NDArray[np.int64], tuple[int, int]]:
    """Return the lowest (row, column) of a window around all that is known, and its shape, a multiple of `factor`."""
    spans = [np.flatnonzero(known.any(axis=axis)) for axis in (1, 0)]
    margin = 4 * factor  # the spline of the matching reads two cells around
    low = np.array([span[0] - margin for span in spans])
    size = [-(-(int(span[-1] - span[0]) + 1 + 2 * margin) // factor) * factor for span in spans]
    return low, (size[0], size[1])


def _cut(cells: NDArray[np.bool_], low: NDArray[np.int64], shape: tuple[int, int]) -> NDArray[np.bool_]:
    result = np.zeros(shape, dtype=np.bool_)
    first, last = np.maximum(low, 0), np.minimum(low + shape, cells.shape)
    into = tuple(slice(a - b, c - b) for a, b, c in zip(first, low, last, strict=True))
    result[into] = cells[first[0] : last[0], first[1] : last[1]]
    return result


def _any(cells: NDArray[np.bool_], factor: int) -> NDArray[np.bool_]:
    rows, cols = cells.shape
    return np.any(cells.reshape(rows // factor, factor, cols // factor, factor), axis=(1, 3))


def _centres(values: NDArray[np.floating], factor: int) -> NDArray[np.floating]:
    """Return `values` at the middles of blocks of `factor` cells: of even blocks the mean of the middle four."""
    rows, cols = (-(-size // factor) * factor for size in values.shape)
    padded = np.pad(values, ((0, rows - values.shape[0]), (0, cols - values.shape[1])), mode="edge")
    first, second = (factor - 1) // 2, factor // 2
    total = padded[first::factor, first::factor] + padded[first::factor, second::factor]
    total += padded[second::factor, first::factor]
    total += padded[second::factor, second::factor]
    total /= 4.0
    return total
