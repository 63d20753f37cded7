"""The true occupancy map of a scene."""

import numpy as np
from numpy.typing import ArrayLike
from scipy import ndimage

from ...slam.geometry import transform_points
from ...slam.occupancy_map import OccupancyMap
from .scene import Scene
from .solids import Solid


def true_map(
    scene: Scene, resolution: float = 0.05, laser_height: float = 0.2, T_world_map: ArrayLike = (0.0, 0.0, 0.0)
) -> OccupancyMap:
    """Return what a perfect laser at `laser_height` could map of `scene`.

    A cell is occupied (1) if its centre lies within half a cell of a solid's surface or inside a solid, and it touches
    reachable free space; free (0) if it is connected with the route; all else is unknown (NaN).

    Args:
        scene: The building.
        resolution: Side of a cell [m].
        laser_height: Height of the laser's plane above the floor [m].
        T_world_map: (3,) pose of the map frame in the world, e.g. the robot's start for comparison with SLAM.
    """
    low, high = _extent(scene, T_world_map)
    low = np.floor(low / resolution) * resolution
    cols, rows = np.ceil((high - low) / resolution).astype(int)
    x, y = np.meshgrid((np.arange(cols) + 0.5) * resolution, (np.arange(rows) + 0.5) * resolution)
    centres = transform_points(T_world_map, (np.stack((x, y), axis=-1) + low).reshape(-1, 2))
    solid_cells = np.zeros((rows, cols), dtype=bool)
    for solid in scene.solids:
        if solid.at_height(laser_height):
            _mark(solid_cells, solid, centres.reshape(rows, cols, 2), low, T_world_map, resolution)
    start = ((_into_map(T_world_map, scene.route[:1]) - low) / resolution).astype(int)[0]
    here = np.zeros_like(solid_cells)
    here[start[1], start[0]] = True
    free = np.asarray(ndimage.binary_propagation(here, mask=~solid_cells), dtype=bool)
    occupied = solid_cells & np.asarray(ndimage.binary_dilation(free, np.ones((3, 3))), dtype=bool)
    probability = np.where(occupied, 1.0, np.where(free, 0.0, np.nan)).astype(np.float32)
    return OccupancyMap(probability, resolution, (float(low[0]), float(low[1])))


def _mark(
    cells: np.ndarray, solid: Solid, centres: np.ndarray, low: np.ndarray, T_world_map: ArrayLike, resolution: float
) -> None:
    """Make those `cells` true whose `centres` (rows, cols, 2) lie in `solid` or within half a cell of it."""
    reach = float(np.hypot(solid.half_length, solid.half_width)) + solid.radius + 2.0 * resolution
    middle = _into_map(T_world_map, np.array([[solid.x, solid.y]]))[0] - low
    first = np.maximum(((middle - reach) / resolution).astype(int), 0)
    last = np.maximum(((middle + reach) / resolution).astype(int) + 1, 0)
    window = (slice(first[1], last[1]), slice(first[0], last[0]))
    cells[window] |= solid.distance(centres[window]) <= resolution / 2.0


def _into_map(T_world_map: ArrayLike, points_world: np.ndarray) -> np.ndarray:
    x, y, theta = np.asarray(T_world_map, dtype=np.float64)
    cos, sin = np.cos(theta), np.sin(theta)
    return (points_world - (x, y)) @ np.array([[cos, -sin], [sin, cos]])


def _extent(scene: Scene, T_world_map: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    x0, y0, x1, y1 = scene.bounds
    corners = _into_map(T_world_map, np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]]))
    return corners.min(axis=0), corners.max(axis=0)
