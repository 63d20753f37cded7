"""A submap: a grid of hit and visit counts that a short stretch of the drive fills, rigid once finished."""

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..bounds import Cell, Reach, Share, check_numbers, check_size, memory_for
from ..errors import InputError
from ..reused_memory import reused_array
from .submap_kernels import bounds, insert_scans
from .sweep import Sweep

_MARGIN_CELLS = 8  # beyond the farthest return: taps of the spline and of neighbouring cells stay inside
_MOST_CELLS = 50_000_000  # of a submap: 350 m x 350 m at 5 cm, 700 MB
_FAR_M = 1e9  # no pose that a match yields from bounded ones is farther off
_GROWTH_M = 4.0  # a grid that must grow gets so much more on that side


@dataclass(frozen=True, kw_only=True)
class SubmapConfig:
    """Settings of `Submap`.

    Attributes:
        resolution: Side of a cell [m].
        prior_visits: Visits without a return that a cell starts with: a first hit counts 1 / (1 + prior_visits).
        free_ray_length: A beam without a return frees so much of its way [m].
        ray_margin: A beam with a return does not free this last share of its way, which it knows no better. Else far
            beams, by their noise, wear away the near side of what stands before others, each next scan is matched a
            little further on, and a corridor is drawn 0.1 % too long.
    """

    resolution: Cell = 0.05
    prior_visits: float = 0.5
    free_ray_length: Reach = 5.0
    ray_margin: Share = 0.01

    def __post_init__(self) -> None:
        check_numbers(self)
        if not self.resolution > 0.0:
            raise InputError(f"`resolution` must be positive [m], got {self.resolution}")
        if not self.prior_visits >= 0.0:
            raise InputError(f"`prior_visits` must not be negative, got {self.prior_visits}")
        if not 0.0 <= self.ray_margin < 1.0:
            raise InputError(f"`ray_margin` must be in [0, 1), got {self.ray_margin}")
        if not self.free_ray_length >= 0.0:
            raise InputError(f"`free_ray_length` must not be negative [m], got {self.free_ray_length}")


class Submap:
    """Hit and visit counts in cells that are laid along the axes of the local frame.

    Args:
        config: Settings.
        pose_local: (3,) T_local_submap: its origin is where the robot began it, its axes are those of the local frame.

    Attributes:
        corner: (2,) centre of cell [0, 0] in the local frame [m].
        scans: Number of scans inside.
        centre: (2,) mean place of the laser, submap frame [m].
    """

    def __init__(self, config: SubmapConfig, pose_local: NDArray[np.float64]) -> None:
        self.config = config
        self.pose_local = np.array([pose_local[0], pose_local[1], 0.0])
        self.scans = 0
        self.centre = np.zeros(2)
        self.corner = np.round(pose_local[:2] / config.resolution) * config.resolution
        self._hits = np.zeros((1, 1), np.float32)
        self._visits = np.zeros((1, 1), np.float32)
        self._field: NDArray[np.float32] | None = np.zeros((1, 1), np.float32)
        self._stamps = np.zeros((1, 1), np.int16)
        self._walls: tuple[NDArray[np.int32], NDArray[np.float32], tuple[int, ...]]  # once finished

    def insert(self, *sweeps: Sweep) -> None:
        """Count scans, given in the local frame, one after the other."""
        with memory_for("a submap"):
            self._cover(bounds(sweep.points) for sweep in sweeps)
        points = np.concatenate([sweep.points for sweep in sweeps])
        sizes = np.array([(len(sweep.points), sweep.returns, sweep.between) for sweep in sweeps])
        insert_scans(
            self._hits,
            self._visits,
            self.field,
            self._stamps,
            self.scans,
            (points - self.corner) * (1.0 / self.config.resolution),
            sizes,
            self.config.prior_visits,
            self.config.ray_margin,
        )
        for sweep in sweeps:
            self.scans += 1
            self.centre += (sweep.sensor - self.pose_local[:2] - self.centre) / self.scans

    def finish(self) -> None:
        """Keep the walls alone, a few hundredths of the memory: there will be no further scans."""
        if self._field is not None:
            cells = np.flatnonzero(self._field).astype(np.int32)
            self._walls = cells, self._field.ravel()[cells], self._field.shape
        self._field, self._hits, self._visits = None, np.zeros((0, 0), np.float32), np.zeros((0, 0), np.float32)
        self._stamps = np.zeros((0, 0), np.int16)

    @property
    def finished(self) -> bool:
        """Whether there will be no further scans."""
        return self._field is None

    @property
    def field(self) -> NDArray[np.float32]:
        """(rows, cols) occupancy of each cell in [0, 1]; 0 where nothing is known. Made anew once finished."""
        if self._field is not None:
            return self._field
        cells, values, shape = self._walls
        field = reused_array(shape, np.float32)
        field.fill(0.0)
        field.ravel()[cells] = values
        return field

    def redrawn(self, sweeps: Iterable[Sweep]) -> "Submap":
        """Return a finished submap in the place of this one, drawn from other `sweeps`, each in the local frame."""
        submap = Submap(self.config, self.pose_local)
        submap.insert(*sweeps)
        submap.finish()
        return submap

    @property
    def resolution(self) -> float:
        """Side of a cell [m]."""
        return self.config.resolution

    @property
    def visits(self) -> NDArray[np.float32]:
        """(rows, cols) how many rays went through the cell or ended there; 0: no scan saw it. Empty once finished."""
        return self._visits

    def _cover(self, extents: Iterable[tuple[float, float, float, float]]) -> None:
        """Enlarge the grids so that what lies between the lowest x, y and the highest of `extents` is well inside.

        Where each of them begins then is the same, to the bit, as if they were given one by one.
        """
        h = self.config.resolution
        (x, y), (rows, cols) = self.corner.tolist(), self.field.shape
        first_row = first_col = 0
        for low_x, low_y, high_x, high_y in extents:
            if not (-_FAR_M <= low_x <= high_x <= _FAR_M and -_FAR_M <= low_y <= high_y <= _FAR_M):
                raise InputError(f"a scan lies where no map reaches ({low_x:g}, {low_y:g}) m; a pose or range is wrong")
            left, right = _growth(low_x, high_x, x, cols, h)
            below, above = _growth(low_y, high_y, y, rows, h)
            x, y = x - left * h, y - below * h
            rows, cols = rows + below + above, cols + left + right
            first_row, first_col = first_row + below, first_col + left
            check_size(cols, rows, h, _MOST_CELLS, "a submap")
        if (rows, cols) == self.field.shape:
            return
        names = ("_hits", "_visits", "_field", "_stamps")
        # All or none: where memory runs out, the submap stays as it is.
        grids = [_enlarged(getattr(self, name), (rows, cols), first_row, first_col) for name in names]
        for name, grid in zip(names, grids, strict=True):
            setattr(self, name, grid)
        self.corner = np.array([x, y])


def _enlarged(grid: NDArray, shape: tuple[int, int], row: int, col: int) -> NDArray:
    """Return an array of `shape` with `grid` from [row, col] on and zeros around it."""
    large, (rows, cols) = reused_array(shape, grid.dtype), grid.shape
    large[:row], large[row + rows :] = 0, 0
    middle = large[row : row + rows]
    middle[:, :col], middle[:, col + cols :] = 0, 0
    middle[:, col : col + cols] = grid
    return large


def _growth(low: float, high: float, corner: float, cells: int, side: float) -> tuple[int, int]:
    """Return how many cells an axis of `cells` from `corner` on lacks before `low` and behind `high` [m], with room."""
    first = math.floor((low - corner) / side) - _MARGIN_CELLS
    last = math.ceil((high - corner) / side) + _MARGIN_CELLS
    more = int(_GROWTH_M / side)
    return (more - first if first < 0 else 0), (last - cells + 1 + more if last >= cells else 0)
