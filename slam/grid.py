"""A log-odds occupancy grid that grows, and maps rendered from a trajectory and its scans."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .bounds import (
    CELLS_A_SCAN,
    FREE_CELLS,
    MOST_CELLS,
    Cell,
    Reach,
    cell_numbers,
    check_numbers,
    check_positive,
    check_size,
    checked_pose,
    memory_for,
)
from .errors import InputError
from .geometry import compose, transform_points
from .grid_kernels import place_rays, write_observation, write_observations
from .occupancy_map import OccupancyMap
from .scan import LaserScan

_MARGIN = 64  # cells to grow beyond what is asked, so that growing is rare
_AT_ONCE = 500  # scans that are drawn together


@dataclass(frozen=True, kw_only=True)
class GridConfig:
    """Parameters of `OccupancyGrid`.

    Attributes:
        resolution: Side of a cell [m].
        hit: Probability of a cell, known from one scan only, in which a ray ended.
        miss: Probability of a cell, known from one scan only, through which rays passed.
        limit: Log-odds stay within +-limit, so that a cell can change its mind.
        max_range: Rays longer than this are cut there, without a hit [m].
        clear_no_return: Whether beams without a return free the cells up to the shorter of `max_range` and the scan's
            own limit. Real lasers report "no return" for black and shining surfaces too, so they say nothing here.
    """

    resolution: Cell = 0.05
    hit: float = 0.7
    miss: float = 0.4
    limit: float = 5.0
    max_range: Reach = 80.0
    clear_no_return: bool = False

    def __post_init__(self) -> None:
        check_numbers(self)
        check_positive(self, "limit", "max_range")
        if not 0.0 < self.miss < 0.5 < self.hit < 1.0:
            raise InputError(f"need 0 < `miss` < 0.5 < `hit` < 1, got {self.miss} and {self.hit}")


def scan_rays(
    scan: LaserScan, max_range: float, clear_no_return: bool = False
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Return (n, 2) the ends of a scan's rays in the laser frame [m], and (n,) whether something was hit there.

    Beams without measurement are left out; those beyond `max_range` [m] are cut there and hit nothing; those without
    a return are left out unless `clear_no_return`.
    """
    limit = min(max_range, scan.range_max)
    chosen = scan.is_return | scan.is_open if clear_no_return else scan.is_return
    ranges = np.minimum(scan.ranges[chosen], limit)
    is_hit = scan.is_return[chosen] & (scan.ranges[chosen] <= max_range)
    return ranges[:, None] * scan.directions[chosen], is_hit


@dataclass(frozen=True, eq=False)
class ScanRays:
    """What a grid takes of a scan, the same wherever the robot was.

    Attributes:
        T_robot_lidar: (3,) pose of the laser [m, m, rad].
        points: (n, 2) the ends of the rays, laser frame [m].
        log_odds: (n,) of what is there; NaN: nothing was hit.
    """

    T_robot_lidar: NDArray[np.float64]
    points: NDArray[np.float64]
    log_odds: NDArray[np.float64]

    @classmethod
    def of(cls, scan: LaserScan, config: GridConfig) -> "ScanRays":
        """Return the rays of a scan."""
        points, is_hit = scan_rays(scan, config.max_range, config.clear_no_return)
        mount = np.array(scan.T_robot_lidar, dtype=np.float64)
        return cls(mount, points, np.where(is_hit, _log_odds(config.hit), np.nan))


class OccupancyGrid:
    """Log-odds of occupancy; each scan updates each cell it met once, a hit before a miss.

    Args:
        config: Parameters.
    """

    _layers = ("_log_odds", "_stamps")

    def __init__(self, config: GridConfig | None = None) -> None:
        self.config = config or GridConfig()
        self._corner = np.zeros(2, dtype=np.int64)  # column and row, in the map, of the cell [0, 0]
        self._log_odds = np.zeros((0, 0), dtype=np.float32)
        self._stamps = np.zeros((0, 0), dtype=np.int32)
        self._scans = 0

    def write(self, T_map_robot: ArrayLike, scan: LaserScan) -> None:
        """Write one scan, taken at the pose `T_map_robot` (3,)."""
        rays = ScanRays.of(scan, self.config)
        self._observe(
            compose(checked_pose(T_map_robot, "T_map_robot"), rays.T_robot_lidar),
            rays.points,
            rays.log_odds,
            _log_odds(self.config.miss),
        )

    def to_map(self) -> OccupancyMap:
        """Return the grid as it is now, cut to what is known; cells that no ray met are NaN."""
        probability = np.negative(self._log_odds)  # then in place: a large map need not be there three times
        np.exp(probability, out=probability)
        probability += np.float32(1.0)
        return self._cut(np.divide(np.float32(1.0), probability, out=probability))

    def _write_together(self, seen: Sequence[tuple[NDArray[np.float64], ScanRays]]) -> None:
        """Do what `write` does, to the same bytes: pairs of T_map_robot (3,) and the rays (one at least) of a scan."""
        sensors = [compose(pose, rays.T_robot_lidar).tolist() for pose, rays in seen]
        places = np.array([(x, y, math.cos(theta), math.sin(theta)) for x, y, theta in sensors])
        points = np.concatenate([rays.points for _, rays in seen])
        firsts = np.cumsum([0, *(len(rays.points) for _, rays in seen)])
        starts, ends, spans = np.empty((len(seen), 2)), np.empty(points.shape), np.empty((len(seen), 2, 2))
        place_rays(places, points, firsts, self.config.resolution, starts, ends, spans)
        corner, size = self._corner, np.array(self._log_odds.shape[:-3:-1])
        corners = np.empty((len(seen) + 1, 2), dtype=np.int64)
        lower, upper = cell_numbers(spans[:, 0]), cell_numbers(spans[:, 1]) + 1
        for k in range(len(seen)):
            corner, size = self._around(corner, size, lower[k], upper[k])
            corners[k] = corner
        corners[-1] = corner
        self._grow(corner, size)
        hits = np.concatenate([rays.log_odds for _, rays in seen])
        miss, limit, stamp = _log_odds(self.config.miss), self.config.limit, self._scans + 1
        write_observations(starts, ends, firsts, corners, hits, miss, limit, stamp, self._log_odds, self._stamps)
        self._scans += len(seen)

    def _observe(
        self, T_map_sensor: NDArray[np.float64], points: NDArray[np.float64], hits: NDArray[np.float64], miss: float
    ) -> None:
        """Write rays to `points` (n, 2), sensor frame, growing where needed.

        Args:
            T_map_sensor: (3,) pose of the sensor.
            points: Where the rays end [m].
            hits: (n,) log-odds of what is there; NaN: nothing is there.
            miss: Log-odds of the cells that the rays pass.
        """
        if not len(points):
            return
        cells = self._cells(np.concatenate((T_map_sensor[None, :2], transform_points(T_map_sensor, points))))
        self._scans += 1
        x, y = cells[0]
        write_observation(x, y, cells[1:], hits, miss, self.config.limit, self._scans, self._log_odds, self._stamps)

    def _cut(self, probability: NDArray[np.float32]) -> OccupancyMap:
        """Return `probability` (rows, cols) of all cells as a map, cut to what is known."""
        return self._cut_known(probability, self._stamps > 0)

    def _cut_known(self, probability: NDArray[np.float32], known: NDArray[np.bool_]) -> OccupancyMap:
        """Return `probability` (rows, cols) as a map, cut to the `known` (rows, cols) cells."""
        if not known.any():
            return OccupancyMap(np.full((1, 1), np.nan, dtype=np.float32), self.config.resolution, (0.0, 0.0))
        rows, cols = np.flatnonzero(known.any(axis=1)), np.flatnonzero(known.any(axis=0))
        window = (slice(rows[0], rows[-1] + 1), slice(cols[0], cols[-1] + 1))
        probability = np.where(known[window], probability[window], np.float32(np.nan))
        x, y = (self._corner + np.array([cols[0], rows[0]])) * self.config.resolution
        return OccupancyMap(probability, self.config.resolution, (float(x), float(y)))

    def _cells(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return `points` (n, 2), map frame [m], as cells, after growing so that all are inside."""
        cells = points / self.config.resolution
        self._reach(cells)
        return cells - self._corner

    def _reach(self, cells: NDArray[np.float64]) -> None:
        """Grow until all `cells` (n, 2) x, y are inside."""
        size = np.array(self._log_odds.shape[:-3:-1])
        lower, upper = cell_numbers(cells.min(axis=0)), cell_numbers(cells.max(axis=0)) + 1
        self._grow(*self._around(self._corner, size, lower, upper))

    def _around(
        self, corner: NDArray[np.int64], size: NDArray[np.int64], lower: NDArray[np.int64], upper: NDArray[np.int64]
    ) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return the corner and size of a grid of `corner` and `size` (2,), once it reaches from `lower` to `upper`."""
        if size.all() and (lower >= corner).all() and (upper <= corner + size).all():
            return corner, size
        lower, upper = lower - _MARGIN, upper + _MARGIN
        if size.all():
            lower, upper = np.minimum(lower, corner), np.maximum(upper, corner + size)
        columns, rows = (upper - lower).tolist()
        most = min(FREE_CELLS + CELLS_A_SCAN * self._scans, MOST_CELLS)
        check_size(columns, rows, self.config.resolution, most / math.prod(self._log_odds.shape[:-2]))
        return lower, upper - lower

    def _grow(self, corner: NDArray[np.int64], size: NDArray[np.int64]) -> None:
        """Grow to a `corner` and `size` (2,) x, y that hold all cells there are."""
        old_size = np.array(self._log_odds.shape[:-3:-1])
        if (corner == self._corner).all() and (size == old_size).all():
            return
        col, row = self._corner - corner if old_size.all() else (0, 0)
        for name in self._layers:
            old = getattr(self, name)
            grown = np.zeros((*old.shape[:-2], *size[::-1]), dtype=old.dtype)
            grown[..., row : row + old.shape[-2], col : col + old.shape[-1]] = old
            setattr(self, name, grown)
        self._corner = corner


def draw(trajectory: NDArray[np.float64], scans: Sequence[ScanRays], config: GridConfig | None = None) -> OccupancyMap:
    """Return the map that `scans` draw, by rays of the same `config`, at the poses of `trajectory` (n, 3)."""
    grid = OccupancyGrid(config)
    seen = [(pose, rays) for pose, rays in zip(trajectory, scans, strict=True) if len(rays.points)]
    with memory_for("the map"):
        for first in range(0, len(seen), _AT_ONCE):
            grid._write_together(seen[first : first + _AT_ONCE])
        return grid.to_map()


def render_map(
    trajectory: NDArray[np.float64], scans: Iterable[LaserScan], config: GridConfig | None = None
) -> OccupancyMap:
    """Return the map that `scans` draw when taken at the poses of `trajectory` (n, 3) T_map_robot."""
    config = config or GridConfig()
    return draw(trajectory, [ScanRays.of(scan, config) for scan in scans], config)


def _log_odds(probability: float) -> float:
    return float(np.log(probability / (1.0 - probability)))
