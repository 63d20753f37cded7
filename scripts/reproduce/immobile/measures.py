"""What is counted on the finished maps: cells of people, desk tops and seats, known area, static cells, the door."""

import numpy as np
from numpy.typing import NDArray

from ....envs.scenes.scene import Scene
from ....slam.geometry import compose, inverse, transform_points
from ....slam.immobile.layers import ImmobileLayers
from ....slam.occupancy_map import OccupancyMap
from ....slam.scan import LaserScan

Array = NDArray[np.float64]

PERSON_M = 0.35
"""Cells within this distance of where somebody was are theirs [m]."""
NEAR_THING_M = 0.1
"""Cells this near to a building or furniture may be its own [m]."""
LASER_HEIGHT = 0.32
"""Height of the laser's plane, the paper's [m]."""
HIDDEN = ("a", "b")
"""Marks of what is hidden behind screens and boxes."""
TOPS = {"table": 0.66, "chair": 0.43}
"""Kinds of things with tops, and the height above which a point of theirs is on the top [m]."""
_JAMB = 0.06
_ON_EDGE_M = 0.02
_FAR = 100_000
_BEYOND_M = 0.1


def inside(polygon: Array, points: Array) -> NDArray[np.bool_]:
    """Return (n,) whether `points` (n, 2) are in the convex `polygon` (k, 2), counter-clockwise."""
    edges = np.roll(polygon, -1, axis=0) - polygon
    offset = points[:, None] - polygon
    return np.asarray((edges[:, 0] * offset[..., 1] - edges[:, 1] * offset[..., 0] >= 0.0).all(axis=1))


def occupied_world(grid: OccupancyMap, T_world_map: Array) -> Array:
    """Return (n, 2) the occupied cells, world frame [m]."""
    return transform_points(T_world_map, grid.occupied_points)


def people_cells(grid: OccupancyMap, T_world_map: Array, scene: Scene, walked: Array) -> int:
    """Return how many occupied cells lie where somebody was, `walked` (n, 2) world frame [m], and nothing else is."""
    cells = occupied_world(grid, T_world_map)
    nearest = np.full(len(cells), np.inf)
    for place in walked:
        nearest = np.minimum(nearest, np.hypot(*(cells - place).T))
    mine = cells[nearest < PERSON_M]
    things = [solid for solid in scene.solids if solid.bottom < 2.0]
    from_things = np.min([solid.distance(mine) for solid in things], axis=0, initial=np.inf)
    return int((from_things > NEAR_THING_M).sum())


def known_cells(grid: OccupancyMap, T_world_map: Array, polygon: Array) -> int:
    """Return how many cells in `polygon` (k, 2), world frame [m], are known."""
    return int(inside(polygon, transform_points(T_world_map, grid.cell_centres(grid.known))).sum())


def cells_in(polygon: Array, T_world_map: Array, resolution: float) -> int:
    """Return how many cells of any map have their centres in `polygon` (k, 2), world frame [m]."""
    corners = transform_points(inverse(T_world_map), polygon)
    low, high = np.floor(corners.min(axis=0) / resolution), np.ceil(corners.max(axis=0) / resolution)
    x, y = (np.arange(low[axis], high[axis]) for axis in (0, 1))
    centres = (np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2) + 0.5) * resolution
    return int(inside(polygon, transform_points(T_world_map, centres)).sum())


def wrongly_free(grid: OccupancyMap, T_world_map: Array, scene: Scene, polygon: Array) -> tuple[int, int]:
    """Return how many cells in `polygon` are truly below or within a thing, and how many of them count as free."""
    free, known = (transform_points(T_world_map, grid.cell_centres(mask)) for mask in (grid.free, grid.known))
    things = [solid for solid in scene.solids if solid.bottom < 1.0]
    found = []
    for cells in (known, free):
        mine = cells[inside(polygon, cells)]
        found.append(int((np.min([s.distance(mine) for s in things], axis=0, initial=np.inf) < -0.03).sum()))
    return found[0], found[1]


def static_cells(conventional: OccupancyMap, T_world_map: Array, scene: Scene) -> Array:
    """Return (n, 2) centres, map frame [m], of the cells that hold a true surface and that the laser alone marks.

    A wall's outer face is no surface of the room: nobody has seen what is marked there.
    """
    outlines = []
    for solid in scene.solids:
        if solid.at_height(LASER_HEIGHT):
            corners = solid.outline()
            ends = np.roll(corners, -1, axis=0)
            for start, end in zip(corners, ends, strict=True):
                count = max(2, int(np.hypot(*(end - start)) / 0.01))
                side = start + np.linspace(0.0, 1.0, count)[:, None] * (end - start)
                outlines.append(side[_from_edges(scene.floor, side) < _ON_EDGE_M] if solid.kind == "wall" else side)
    points = transform_points(inverse(T_world_map), np.concatenate(outlines))
    cells = np.unique(np.floor(points / conventional.resolution), axis=0)
    centres = (cells + 0.5) * conventional.resolution
    return centres[marked(conventional, centres)]


def _from_edges(polygon: Array, points: Array) -> Array:
    """Return (n,) how far `points` (n, 2) are from the nearest edge of `polygon` (k, 2) [m]."""
    edge = np.roll(polygon, -1, axis=0) - polygon
    offset = points[:, None] - polygon
    along = np.clip((offset * edge).sum(axis=-1) / (edge * edge).sum(axis=-1), 0.0, 1.0)
    return np.hypot(*(offset - along[..., None] * edge).transpose(2, 0, 1)).min(axis=1)


def lost_cells(grid: OccupancyMap, cells: Array, reach: int) -> int:
    """Return how many of `cells` (n, 2), map frame [m], have no occupied cell of `grid` within `reach` cells."""
    return int((~marked(grid, cells, reach)).sum())


def marked(grid: OccupancyMap, cells: Array, reach: int = 0) -> NDArray[np.bool_]:
    """Return (n,) whether the map is occupied at `cells` (n, 2), map frame [m], or within `reach` cells of them."""
    wide = np.pad(grid.occupied, reach)
    grown = np.zeros_like(grid.occupied)
    for dy in range(2 * reach + 1):
        for dx in range(2 * reach + 1):
            grown |= wide[dy : dy + grown.shape[0], dx : dx + grown.shape[1]]
    col, row = np.floor((cells - grid.origin) / grid.resolution).astype(int).T
    ok = (row >= 0) & (col >= 0) & (row < grown.shape[0]) & (col < grown.shape[1])
    found = np.zeros(len(cells), dtype=bool)
    found[ok] = grown[row[ok], col[ok]]
    return found


def cell_numbers(points: Array, resolution: float) -> set[int]:
    """Return one number for each cell that `points` (n, 2) [m] lie in."""
    column, row = np.floor(points / resolution).astype(np.int64).T + _FAR
    return set(np.unique(column * (2 * _FAR) + row).tolist())


def centres_of(numbers: set[int], resolution: float) -> Array:
    """Return (n, 2) the centres [m] of cells given by `cell_numbers`, in the order of the numbers."""
    cells = np.stack(np.divmod(np.array(sorted(numbers), dtype=np.int64), 2 * _FAR), axis=-1) - _FAR
    return (cells + 0.5) * resolution


class SeenTops:
    """Cells of desk tops and seats that the camera has really seen.

    Args:
        scene: The building.
        T_world_map: (3,) where the map is in the world.
        resolution: Side of a cell [m].
    """

    def __init__(self, scene: Scene, T_world_map: Array, resolution: float) -> None:
        self._resolution = resolution
        self._cells: dict[str, set[int]] = {kind: set() for kind in TOPS}
        self._true: dict[str, set[int]] = {kind: set() for kind in TOPS}
        for solid in scene.solids:
            if solid.kind in TOPS:
                reach = np.arange(-1.6, 1.6, 0.25 * resolution)
                around = np.stack(np.meshgrid(solid.x + reach, solid.y + reach), axis=-1).reshape(-1, 2)
                within = transform_points(inverse(T_world_map), around[solid.distance(around) < 0.0])
                self._true[solid.kind] |= cell_numbers(within, resolution)

    def add(self, kind: str, points: Array) -> None:
        """Add what was seen of a kind at `points` (n, 2), map frame [m]."""
        self._cells[kind] |= cell_numbers(points, self._resolution)

    def share(self, kind: str, grid: OccupancyMap) -> tuple[int, int]:
        """Return how many true cells of `kind` were seen, and how many of those are occupied in `grid`."""
        cells = centres_of(self._cells[kind] & self._true[kind], self._resolution)
        return len(cells), int(marked(grid, cells).sum())


class DoorWatch:
    """Notes when each cell of an open door is seen open, and when the map lets it go.

    Args:
        scene: The building; its first door.
        T_map_world: (3,) where the world is in the map.
        resolution: Side of a cell [m].
    """

    def __init__(self, scene: Scene, T_map_world: Array, resolution: float) -> None:
        door = scene.doors[0]
        along = np.array([np.cos(door.yaw), np.sin(door.yaw)])
        across = np.array([-along[1], along[0]])
        grid = np.mgrid[_JAMB : door.width - _JAMB : resolution / 2, -0.025 : 0.026 : resolution / 2].reshape(2, -1).T
        world = np.array(door.hinge) + grid[:, :1] * along + grid[:, 1:] * across
        cells = np.unique(np.floor(transform_points(T_map_world, world) / resolution), axis=0)
        self.cells, self._resolution = (cells + 0.5) * resolution, resolution
        self._seen, self._cleared = np.full(len(cells), np.nan), np.full(len(cells), np.nan)
        self._looks = np.zeros(len(cells), dtype=np.int64)
        self._was = np.zeros(len(cells), dtype=bool)

    def closed(self, grid: OccupancyMap) -> None:
        """Note which cells are occupied while the door is closed."""
        self._was |= marked(grid, self.cells)

    def opened(self, T_map_robot: Array, scan: LaserScan, grid: OccupancyMap) -> None:
        """Note which cells the scan sees through, the door being open, and which the map still holds."""
        now = self._crossed(compose(T_map_robot, scan.T_robot_lidar), scan)
        self._seen[np.isnan(self._seen) & now] = scan.time_s
        self._looks[now & np.isnan(self._cleared)] += 1
        free = ~np.isnan(self._seen) & np.isnan(self._cleared) & ~marked(grid, self.cells)
        self._cleared[free] = scan.time_s

    def _crossed(self, T_map_lidar: Array, scan: LaserScan) -> NDArray[np.bool_]:
        """Return (n,) through which cells a ray went, past the middle by less than half a cell, to a return beyond."""
        cells = transform_points(inverse(T_map_lidar), self.cells)
        bearing, distance = np.arctan2(cells[:, 1], cells[:, 0]), np.hypot(*cells.T)
        after = np.clip(np.searchsorted(scan.bearings, bearing), 1, len(scan) - 1)
        beam = after - (bearing - scan.bearings[after - 1] < scan.bearings[after] - bearing)
        aside = distance * np.abs(np.sin(bearing - scan.bearings[beam]))
        return scan.is_return[beam] & (scan.ranges[beam] > distance + _BEYOND_M) & (aside < self._resolution / 2.0)

    def looks(self) -> NDArray[np.int64]:
        """Return (n,) how many scans saw through each of those cells until it was cleared, that one included."""
        return self._looks[self._was & ~np.isnan(self._seen)]

    def delays(self) -> Array:
        """Return (n,) from being seen open to being cleared, of the cells that were occupied and seen [s]; inf: never.

        Cells that had gone before they were seen open count as cleared at once.
        """
        mine = self._was & ~np.isnan(self._seen)
        return np.where(np.isnan(self._cleared), np.inf, self._cleared - self._seen)[mine]

    def still(self, grid: OccupancyMap) -> int:
        """Return how many of those cells `grid` holds."""
        return int(marked(grid, self.cells[self._was & ~np.isnan(self._seen)]).sum())


def layered(grid: ImmobileLayers) -> dict[str, OccupancyMap]:
    """Return all maps of a layered grid, by name."""
    return {"map": grid.to_map(), "movable": grid.movable(), "overlooked": grid.overlooked(), "laser": grid.laser_map()}
