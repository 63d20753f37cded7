"""Immobile area in layers of height, so that a laser and a camera write one map of the plane.

Zhang et al. 2019 write both sensors into one grid. A laser that looks below a desk would then erase what the camera
sees of its top, and a camera that looks over a box would erase the box. So each layer of height has odds of its own by
eq. 4 and 5, and a ray frees only the layers that it passes; the map of the plane is what all layers say together.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..bounds import check_numbers
from ..errors import InputError
from ..geometry import compose, transform_points
from ..grid import OccupancyGrid, scan_rays
from ..grid_kernels import write_observation
from ..occupancy_map import OccupancyMap
from ..scan import LaserScan
from .grid import UNKNOWN, ImmobileConfig
from .layer_kernels import Layers, Rays, write_view

Array = NDArray[np.float64]

_FAR = 99
_AROUND = np.stack(np.meshgrid((-1, 0, 1), (-1, 0, 1)), axis=-1).reshape(-1, 2)


@dataclass(frozen=True, kw_only=True)
class LayersConfig(ImmobileConfig):
    """Parameters of `ImmobileLayers`; those of `ImmobileConfig` and these.

    A ray frees as gently as in `OccupancyGrid`, since unknown returns weigh less here than there; the lower limit lets
    a door go in time.

    Attributes:
        miss: P(O) of a cell through which a ray passed.
        limit: Log-odds stay within +-limit.
        gone: Log-odds below which a cell that was firm counts as left.
        edges: Heights between the layers [m]; below the first is floor. The last layer is what hangs overhead: it
            counts only where nothing is known of the layers below it, as of a wall behind a screen; a lintel does not
            close its doorway.
        laser_height: Height of the laser's plane [m].
        sure: What has at least this lambda was recognised for certain: walls, tops.
        nearest: The camera frees nothing nearer than this [m].
        believed: What was written less firmly than this, as by one look at somebody's back, is not in the map where the
            laser sees that nothing stands there; log-odds.
        together: What stood beside a cell that was left, and so many cells on, leaves with it.
        overlooked: Log-odds of a free cell of which neither floor nor laser say that it is free: somebody has looked
            over it.
    """

    miss: float = 0.4
    limit: float = 3.5
    gone: float = -0.5
    edges: tuple[float, ...] = (0.06, 0.25, 0.40, 0.65, 0.80, 1.0, 1.3, 1.6, 2.0, 3.0)
    laser_height: float = 0.32
    sure: float = 7.0
    nearest: float = 0.4
    believed: float = 1.5
    together: int = 2
    overlooked: float = -0.4

    def __post_init__(self) -> None:
        check_numbers(self)
        super().__post_init__()
        if len(self.edges) < 3 or not np.all(np.diff(self.edges) > 0.0):
            raise InputError(f"`edges` are at least three rising heights [m], got {self.edges}")
        if not self.edges[0] <= self.laser_height < self.edges[-2]:
            raise InputError(f"`laser_height` must be in a layer below the last, got {self.laser_height} m")
        if not 0.0 <= self.believed <= self.limit:
            raise InputError(f"`believed` must be in [0, `limit`], got {self.believed}")
        if self.together < 0:
            raise InputError(f"`together` must not be negative [cells], got {self.together}")
        if not self.overlooked < 0.0:
            raise InputError(f"`overlooked` must be negative, got {self.overlooked}")

    @property
    def laser_layer(self) -> int:
        """Number of the layer that the laser sees."""
        return int(np.searchsorted(self.edges, self.laser_height, side="right")) - 1


class ImmobileLayers(OccupancyGrid):
    """Log-odds of immobile area by layers of height.

    A thing that stood firmly in the laser's layer and has left is gone in all layers, as whatever stands there has a
    foot; the camera need not look again. Only the tops of desks and seats stay, whose feet are elsewhere.

    Args:
        config: Parameters.
    """

    config: LayersConfig
    _layers = ("_log_odds", "_stamps", "_spans", "_tops", "_firm", "_left", "_movable", "_mobile")

    def __init__(self, config: LayersConfig | None = None) -> None:
        super().__init__(config or LayersConfig())
        count = len(self.config.edges) - 1
        self._edges = np.array(self.config.edges)
        self._log_odds = np.zeros((count, 0, 0), dtype=np.float32)
        self._stamps = np.zeros((count, 0, 0), dtype=np.int32)
        self._spans = np.zeros((2, count, 0, 0), dtype=np.float32)
        self._tops = np.zeros((count, 0, 0), dtype=np.bool_)
        self._firm, self._movable, self._mobile = (np.zeros((0, 0), dtype=np.bool_) for _ in range(3))
        self._left = np.zeros((0, 0), dtype=np.int8)  # 1: left by itself; k: with what is k - 1 cells away; 0: not

    def write(self, T_map_robot: ArrayLike, scan: LaserScan, lambdas: ArrayLike = UNKNOWN) -> None:
        """Write one scan, taken at the pose `T_map_robot` (3,), into the laser's layer.

        Args:
            T_map_robot: Pose of the robot when the scan was taken.
            scan: The scan.
            lambdas: Lambda of each beam's return (N,), or one for all; see `still_lambda` and `moving_lambda`.
        """
        each = np.broadcast_to(np.asarray(lambdas, dtype=np.float64), scan.ranges.shape)
        chosen = scan.is_return | (scan.is_open & self.config.clear_no_return)
        points, is_hit = scan_rays(scan, self.config.max_range, self.config.clear_no_return)
        if not len(points):
            return
        beta = self._log_beta(np.where(is_hit, each[chosen], np.nan))
        order = np.argsort(beta, kind="stable")
        T_map_lidar = compose(T_map_robot, scan.T_robot_lidar)
        cells = self._cells(np.concatenate((T_map_lidar[None, :2], transform_points(T_map_lidar, points[order]))))
        layer, config = self.config.laser_layer, self.config
        self._scans += 1
        log_odds, stamps = self._log_odds[layer], self._stamps[layer]
        self._note_mobile(cells[1:], beta[order])
        miss = float(np.log(UNKNOWN * config.miss))
        write_observation(
            cells[0, 0], cells[0, 1], cells[1:], beta[order], miss, config.limit, self._scans, log_odds, stamps
        )
        self._firm |= log_odds >= config.firm
        self._clear_columns(layer)

    def write_view(
        self,
        T_map_camera: ArrayLike,
        height: float,
        points: ArrayLike,
        lambdas: ArrayLike,
        above: ArrayLike,
        level: ArrayLike = False,
    ) -> None:
        """Write what a camera saw.

        Args:
            T_map_camera: (3,) pose of the camera in the plane when it was exposed, see `PoseHistory`.
            height: Its height above the floor [m].
            points: (n, 3) what it saw, in its own frame turned level, heights above the floor [m].
            lambdas: (n,) lambda of what is there; NaN where the ray ends on something that stands in nobody's way.
            above: (n,) rays free nothing where they are lower than this [m].
            level: (n,) or one: whether it is a level top, which stays where it is when what stands below it leaves.

        Raises:
            InputError: If the shapes differ or a lambda is not positive.
        """
        ends, each = np.asarray(points, dtype=np.float64), np.asarray(lambdas, dtype=np.float64)
        lowest = np.asarray(above, dtype=np.float64)
        if ends.shape != (len(each), 3) or lowest.shape != each.shape:
            raise InputError(f"points, lambdas and above differ: {ends.shape}, {each.shape}, {lowest.shape}")
        if not len(ends):
            return
        pose, config = np.asarray(T_map_camera, dtype=np.float64), self.config
        beta = self._log_beta(each)
        order = np.argsort(beta, kind="stable")
        flat = self._cells(np.concatenate((pose[None, :2], transform_points(pose, ends[order, :2]))))
        cells = np.concatenate((flat, np.append(height, ends[order, 2])[:, None]), axis=1)
        near, sure, miss = round(config.nearest / config.resolution), each >= config.sure, np.log(UNKNOWN * config.miss)
        self._scans += 1
        self._note_mobile(cells[1:], beta[order])
        known = (sure.astype(np.int8) + (sure & np.asarray(level)))[order]
        rays = Rays(cells[0], cells[1:], beta[order], lowest[order], known)
        layers = Layers(self._edges, self._log_odds, self._stamps, self._spans, self._tops)
        write_view(rays, layers, near, float(miss), config.limit, self._scans)
        self._firm |= self._log_odds[config.laser_layer] >= config.firm

    def write_mobile(self, place: ArrayLike, radius: float, lam: float) -> None:
        """Write what moves at a `place` (2,), map frame [m], into all cells within `radius` [m] of it, in all layers.

        It may have been taken for a thing from another side. Cells of what was recognised as staying are left alone.
        """
        centre = np.asarray(place, dtype=np.float64)
        reach = np.arange(-radius, radius + 1e-9, 0.5 * self.config.resolution)
        disc = np.stack(np.meshgrid(reach, reach), axis=-1).reshape(-1, 2)
        cells = self._cells(centre + disc[np.hypot(disc[:, 0], disc[:, 1]) <= radius])
        col, row = np.unique(np.floor(cells).astype(int), axis=0).T
        stays = self._recognised(row, col)
        row, col = row[~stays], col[~stays]
        before = self._log_odds[:, row, col]
        after = np.maximum(before + np.float32(np.log(lam * self.config.hit)), -np.float32(self.config.limit))
        self._log_odds[:, row, col] = np.where(before > 0.0, after, before)

    def is_recognised(self, T_map_frame: ArrayLike, points: ArrayLike) -> NDArray[np.bool_]:
        """Return (n,) whether something that stays was recognised, by the camera, in the cell of each of the `points`.

        Args:
            T_map_frame: (3,) pose of the points' frame.
            points: (n, 2) places [m]; NaN for none.
        """
        where = transform_points(np.asarray(T_map_frame, dtype=np.float64), np.asarray(points, dtype=np.float64))
        cells = np.nan_to_num(where / self.config.resolution - self._corner, nan=-1.0)
        col, row = np.floor(cells).astype(int).T
        found = np.zeros(len(col), dtype=np.bool_)
        inside = (row >= 0) & (col >= 0) & (row < self._left.shape[0]) & (col < self._left.shape[1])
        found[inside] = self._recognised(row[inside], col[inside])
        return found

    def log_odds_around(self, T_map_frame: ArrayLike, points: ArrayLike, heights: ArrayLike) -> Array:
        """Return (n,) the highest log-odds of each point's cell and its eight neighbours in its layer; 0 if unknown.

        Args:
            T_map_frame: (3,) pose of the points' frame.
            points: (n, 2) places [m].
            heights: (n,) above the floor, or one for all [m].
        """
        pose, where = np.asarray(T_map_frame, dtype=np.float64), np.asarray(points, dtype=np.float64)
        cells = transform_points(pose, where) / self.config.resolution - self._corner
        col, row = np.floor(cells).astype(int).T
        layer = np.clip(np.searchsorted(self._edges, heights, side="right") - 1, 0, len(self._edges) - 2)
        layer = np.broadcast_to(layer, col.shape)
        highest = np.full(len(col), -np.inf)
        for dy in (-1, 0, 1):
            for dx in (-1, 0, 1):
                y, x = row + dy, col + dx
                inside = (x >= 0) & (y >= 0) & (x < self._left.shape[1]) & (y < self._left.shape[0])
                value = np.zeros(len(col))
                value[inside] = self._log_odds[layer[inside], y[inside], x[inside]]
                highest = np.maximum(highest, value)
        return highest

    def to_map(self) -> OccupancyMap:
        """Return the map of the plane: in each cell what the most occupied layer says; NaN where no ray passed."""
        odds, known = self._low()
        overhead = ~known & (self._stamps[-1] > 0)
        odds = np.where(overhead, self._log_odds[-1], odds)
        odds = np.where(self._seen_over(odds), np.maximum(odds, self.config.overlooked), odds)
        return self._cut((1.0 / (1.0 + np.exp(-odds))).astype(np.float32))

    def laser_map(self) -> OccupancyMap:
        """Return the laser's layer alone."""
        layer = self.config.laser_layer
        probability = (1.0 / (1.0 + np.exp(-self._log_odds[layer]))).astype(np.float32)
        return self._cut_known(probability, self._stamps[layer] > 0)

    def overlooked(self) -> OccupancyMap:
        """Return 1 where a cell counts as free only because somebody looked over it, 0 elsewhere."""
        odds, known = self._low()
        odds = np.where(~known & (self._stamps[-1] > 0), self._log_odds[-1], odds)
        return self._cut(self._seen_over(odds).astype(np.float32))

    def movable(self) -> OccupancyMap:
        """Return the layer of movable things: 1 where something not known as alive stood firmly and has left."""
        return self._cut(self._movable.astype(np.float32))

    def _low(self) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
        """Return (rows, cols) log-odds by all layers below the last together, and whether any of them is known."""
        seen = self._stamps[:-1] > 0
        known = np.asarray(seen.any(axis=0))
        highest = np.where(seen, self._log_odds[:-1], -np.inf).max(axis=0, initial=-np.inf)
        doubtful = (highest < self.config.believed) & (self._log_odds[self.config.laser_layer] < self.config.gone)
        highest = np.where(doubtful, np.minimum(highest, np.float32(self.config.overlooked)), highest)
        return np.where(known, highest, np.float32(0.0)), known

    def _seen_over(self, odds: NDArray[np.float32]) -> NDArray[np.bool_]:
        """Return (rows, cols) the free cells of which neither the floor's layer nor the laser's is known."""
        below = (self._stamps[: self.config.laser_layer + 1] > 0).any(axis=0)
        return np.asarray((self._stamps > 0).any(axis=0) & ~below & (odds < 0.0))

    def _cut(self, probability: NDArray[np.float32]) -> OccupancyMap:
        return self._cut_known(probability, np.asarray((self._stamps > 0).any(axis=0)))

    def _recognised(self, row: NDArray[np.intp], col: NDArray[np.intp]) -> NDArray[np.bool_]:
        """Return (n,) whether cells firmly hold what was recognised for certain, in any layer."""
        firm = (self._spans[1][:, row, col] > 0.0) & (self._log_odds[:, row, col] >= self.config.firm)
        return np.asarray(firm.any(axis=0))

    def _log_beta(self, lambdas: Array) -> Array:
        if not np.all(np.isnan(lambdas) | (lambdas > 0.0)):
            raise InputError(f"lambda must be positive, got {np.nanmin(lambdas)}")
        return np.log(lambdas * self.config.hit)

    def _note_mobile(self, cells: Array, beta: Array) -> None:
        """Note where what moves is met now; not while what stood there is just being found to have left.

        So a door that somebody walks through, having opened it, is not taken for somebody.
        """
        moving = cells[beta < np.log(UNKNOWN * self.config.hit) - 1e-9]
        row, col = np.floor(moving[:, 1]).astype(int), np.floor(moving[:, 0]).astype(int)
        odds = self._log_odds[self.config.laser_layer, row, col]
        settled = (odds < self.config.gone) | (odds >= self.config.firm)
        self._mobile[row[settled], col[settled]] = True

    def _clear_columns(self, layer: int) -> None:
        """Empty all layers where what stood firmly in the laser's `layer` has left."""
        log_odds, config = self._log_odds[layer], self.config
        again = log_odds >= config.firm
        self._left[again], self._movable[again] = 0, False
        while len(leaving := self._leaving(log_odds)):
            for row, col, level in leaving:
                before, self._left[row, col] = self._left[row, col], level
                if before:
                    continue
                self._movable[row, col], self._mobile[row, col] = not self._mobile[row, col], False
                window = (slice(max(row - 1, 0), row + 2), slice(max(col - 1, 0), col + 2))
                # the camera may have seen it in the next cell, too
                columns, spans = self._log_odds[:, *window], self._spans[:, :, *window]
                goes = (log_odds[window] < config.gone) & ~self._tops[:, *window]
                goes[:, row - window[0].start, col - window[1].start] = ~self._tops[:, row, col]
                columns[goes] = np.minimum(columns[goes], np.float32(config.gone))
                spans[:, goes] = 0.0

    def _leaving(self, log_odds: NDArray[np.float32]) -> NDArray[np.intp]:
        """Return (n, 3) row, column and level (see `_left`) of the cells out of which something firm has left now.

        By itself, by the laser's `log_odds`, a cell must be free beyond doubt, and no neighbour occupied: noise moves
        the returns of a wall from cell to cell. But a thing leaves as a whole: up to `together` cells beside one that
        it has left by itself it is enough to be occupied no more, so that the ends of a door go with its leaf though
        they touch the jambs.
        """
        row, col = np.nonzero(self._firm & (self._left != 1) & (log_odds < 0.0))
        near = np.clip(np.stack((row, col), axis=-1)[:, None] + _AROUND, 0, np.array(log_odds.shape) - 1)
        around, levels = log_odds[near[..., 0], near[..., 1]], self._left[near[..., 0], near[..., 1]]
        beside = np.where((levels > 0) & (around < 0.0), levels.astype(np.intp), _FAR).min(axis=1, initial=_FAR) + 1
        alone = (around <= 0.0).all(axis=1) & (log_odds[row, col] < self.config.gone)
        level, before = np.where(alone, 1, beside), self._left[row, col]
        new = (level <= 1 + self.config.together) & ((before == 0) | (level < before))
        return np.stack((row, col, level), axis=-1)[new]
