"""The maps of all particles: tiles of counted cells, shared copy-on-write."""

import numpy as np
from numpy.typing import NDArray

from ..bounds import cell_numbers, check_size, memory_for
from ..errors import InputError
from ..occupancy_map import OccupancyMap
from ..processes.threads import Workers
from ..rigid_kernel import move_points
from .tile_kernels import SIDE, mark_particles, own_tiles, write_particles

Array = NDArray[np.float64]

_MOST_PLACES = 30_000_000  # of all directories; for 30 particles and cells of 0.05 m that is 1.6 x 1.6 km
_FREE_TILES = 48_000  # 600 MB; a drive through a large building (ACES, 57 m x 57 m) takes 5600
_TILES_A_SCAN = 200  # more for each scan: half of what one sees 20 m around it, by 30 particles that all differ
_OCCUPIED_SHARE = 0.25  # of the visits that were hits, as the ROS wrapper draws its map


class TileMaps:
    """One map per particle; what particles have in common is stored once.

    A resampled particle takes its parent's directory of tiles; a tile is copied only when one of those who share it
    writes into it. Tile 0 is empty, and belongs to all.

    Args:
        particles: Number of maps.
        cell: Side of a cell [m].
        fullness: A cell is occupied when more than this share of its visits were hits.
        workers: Threads to write with.
        margin: The last share of a ray before a hit that visits nothing.
    """

    def __init__(self, particles: int, cell: float, fullness: float, workers: Workers, margin: float = 0.0) -> None:
        self.cell = cell
        self.margin = margin
        self.fullness = fullness
        self._workers = workers
        self.origin = np.zeros(2, dtype=np.int64)  # tile coordinates (column, row) of directory[:, 0, 0]
        self.directory = np.zeros((particles, 1, 1), dtype=np.int32)
        self.counts = np.zeros((1, SIDE * SIDE, 2), dtype=np.uint16)
        self.means = np.zeros((1, SIDE * SIDE, 2), dtype=np.float32)
        self.bits = np.zeros((1, SIDE), dtype=np.uint32)
        self.near = np.zeros((1, SIDE), dtype=np.uint64)
        self._references = np.zeros(1, dtype=np.int64)
        self._free = np.zeros(1, dtype=np.int64)
        self._free_count = 0
        self._used = np.zeros(1, dtype=np.bool_)  # whether a tile was ever given to a particle
        self._scans = 0  # written so far

    @property
    def tiles(self) -> int:
        """How many tiles are stored."""
        return len(self.bits) - 1 - self._free_count

    def to_cells(self, points_map: Array) -> Array:
        """Return points (..., 2) of the map frame [m] in cells from the directory's corner."""
        return points_map / self.cell - self.origin * SIDE

    def write(self, T_map_lidar: Array, points_lidar: Array, is_hit: NDArray[np.bool_]) -> None:
        """Write one scan into every map.

        Args:
            T_map_lidar: (particles, 3) pose of the laser by each particle.
            points_lidar: (n, 2) ends of the rays in the laser frame [m].
            is_hit: (n,) whether the ray hit something at its end.
        """
        self._scans += 1
        ends, starts = _placed(T_map_lidar, points_lidar), T_map_lidar[:, :2]
        with memory_for("the maps of all particles"):
            self._reach(np.concatenate((_corners(ends.reshape(-1, 2)), _corners(starts))))
        origins = self.to_cells(starts)
        ends /= self.cell
        ends -= self.origin * SIDE
        needed = np.zeros(self.directory.shape, dtype=np.bool_)
        count = len(T_map_lidar)
        self._workers.run(lambda start, stop: mark_particles(start, stop, origins, ends, needed), count)
        with memory_for("the maps of all particles"):
            self._own(needed)
        self._workers.run(
            lambda start, stop: write_particles(
                start,
                stop,
                origins,
                ends,
                is_hit,
                self.margin,
                self.fullness,
                needed,
                self.directory,
                self.counts,
                self.means,
                self.bits,
                self.near,
            ),
            count,
        )

    def resample(self, parents: NDArray[np.intp]) -> None:
        """Let map i become what map `parents[i]` is now; nothing is copied but directories."""
        self.directory = self.directory[parents]
        self._references = np.bincount(self.directory.ravel(), minlength=len(self.bits))
        unused = np.flatnonzero(self._references == 0)
        self._free_count = len(unused)
        self._free[: len(unused)] = unused[::-1]

    def to_map(self, particle: int) -> OccupancyMap:
        """Return a particle's own map: the share of hits among the visits of a cell; NaN where there were none."""
        directory = self.directory[particle]
        rows, cols = np.flatnonzero(directory.any(axis=1)), np.flatnonzero(directory.any(axis=0))
        if not len(rows):
            return OccupancyMap(np.full((1, 1), np.nan, dtype=np.float32), self.cell, (0.0, 0.0))
        tiles = self.counts[directory[rows[0] : rows[-1] + 1, cols[0] : cols[-1] + 1]]
        hits, visits = tiles[..., 0].astype(np.float32), tiles[..., 1]
        share = np.where(visits > 0, hits / np.maximum(visits, 1), np.float32(np.nan))
        height, width = share.shape[:2]
        plain = share.reshape(height, width, SIDE, SIDE).swapaxes(1, 2).reshape(height * SIDE, width * SIDE)
        x, y = (self.origin + np.array([cols[0], rows[0]])) * (SIDE * self.cell)
        return OccupancyMap(plain, self.cell, (float(x), float(y)), _OCCUPIED_SHARE, _OCCUPIED_SHARE)

    def _own(self, needed: NDArray[np.bool_]) -> None:
        shared = needed & ((self.directory == 0) | (self._references[self.directory] > 1))
        self._reserve(int(np.count_nonzero(shared)))
        self._free_count = own_tiles(
            needed,
            self.directory,
            self._references,
            self._free,
            self._free_count,
            self._used,
            self.counts,
            self.means,
            self.bits,
            self.near,
        )

    def _reserve(self, count: int) -> None:
        """Have at least `count` free tiles."""
        if count <= self._free_count:
            return
        old = len(self.bits)
        most = _FREE_TILES + _TILES_A_SCAN * self._scans
        new = max(old + count, min(2 * old, most))
        if new > most:
            raise InputError(
                f"the maps of {len(self.directory)} particles would take {new} tiles of {SIDE} x {SIDE} cells, more "
                f"than {most}; take fewer particles, larger cells or a shorter `max_urange`"
            )
        names = ("counts", "means", "bits", "near", "_references", "_free", "_used")
        # All or none: where memory runs out, the maps stay as they are.
        more = [np.zeros((new, *getattr(self, name).shape[1:]), dtype=getattr(self, name).dtype) for name in names]
        for name, grown in zip(names, more, strict=True):
            grown[:old] = getattr(self, name)
            setattr(self, name, grown)
        self._free[self._free_count : self._free_count + new - old] = np.arange(new - 1, old - 1, -1)
        self._free_count += new - old

    def _reach(self, points_map: Array) -> None:
        """Grow the directories so that `points_map` (n, 2) and a margin lie inside; the first ones begin there."""
        size = np.array(self.directory.shape[:0:-1])
        least, most = cell_numbers(_corners(points_map) / (self.cell * SIDE))
        first = self.tiles == 0
        low, high = (least, least) if first else (self.origin, self.origin + size)
        lower = np.minimum(least - 1, low)
        upper = np.maximum(most + 2, high)
        if (lower == low).all() and (upper == high).all():
            return
        lower -= np.where(lower < low, 4, 0)
        upper += np.where(upper > high, 4, 0)
        columns, rows = (int(places) for places in upper - lower)
        most = _MOST_PLACES * SIDE**2 / len(self.directory)
        check_size(columns * SIDE, rows * SIDE, self.cell, most)
        grown = np.zeros((len(self.directory), rows, columns), dtype=np.int32)
        if not first:
            column, row = self.origin - lower
            grown[:, row : row + size[1], column : column + size[0]] = self.directory
        self.directory, self.origin = grown, lower
        self._references[0] = np.count_nonzero(grown == 0)


def _placed(poses: Array, points: Array) -> Array:
    """Return `points` (n, 2) seen from each of `poses` (P, 3) in their frame, (P, n, 2)."""
    placed, cos, sin = np.empty((len(poses), *points.shape)), np.cos(poses[:, 2]), np.sin(poses[:, 2])
    for p in range(len(poses)):
        move_points(poses[p, 0], poses[p, 1], cos[p], sin[p], points, placed[p])
    return placed


def _corners(points: Array) -> Array:
    """Return (2, 2) the lowest and the highest x and y of `points` (n, 2)."""
    return np.array([[side.min() for side in points.T], [side.max() for side in points.T]])
