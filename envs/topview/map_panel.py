"""The growing map as a picture."""

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from ...slam.geometry import compose, inverse, transform_points
from ...slam.occupancy_map import OccupancyMap
from . import palette
from .canvas import Camera, Canvas
from .snapshot import Snapshot


class MapPanel:
    """Draws the map in the world frame; cells are sampled anew only when the map has changed.

    Args:
        size: Width and height [pixel].
        bounds: (x_min, y_min, x_max, y_max) of the building [m].
    """

    def __init__(self, size: tuple[int, int], bounds: tuple[float, float, float, float]) -> None:
        x_min, y_min, x_max, y_max = bounds
        scale = min(size[0] / (x_max - x_min + 1.0), size[1] / (y_max - y_min + 1.0))
        self._camera = Camera(((x_min + x_max) / 2, (y_min + y_max) / 2), scale, size)
        self._map: OccupancyMap | None = None
        self._cells = Image.new("RGB", size, palette.MAP_UNKNOWN)

    def draw(self, shot: Snapshot) -> Image.Image:
        """Return the map with the robot's path, the robot and its leader."""
        if shot.map is not None and shot.map is not self._map:
            self._map = shot.map
            self._cells = Image.fromarray(sample_map(shot.map, shot.T_world_map, self._camera))
        canvas = Canvas(self._cells.copy(), self._camera)
        pixel = 1.0 / self._camera.scale
        if len(shot.path) > 1:
            canvas.line(shot.path, (*palette.PATH[:3], 255), 2.5 * pixel)
        if shot.tracks.leader is not None:
            canvas.circle(shot.tracks.leader, 4.5 * pixel, palette.LEADER)
        nose = transform_points(shot.robot_pose, np.array([(10.0, 0.0), (-5.0, 5.5), (-5.0, -5.5)]) * pixel)
        canvas.polygon(nose, palette.RETURN)
        return canvas.picture


def sample_map(grid: OccupancyMap, T_world_map: NDArray[np.float64], camera: Camera) -> NDArray[np.uint8]:
    """Return (height, width, 3) colours of the map's cells under each pixel of `camera`.

    A pixel that covers several cells shows the darkest of four, so that thin walls do not vanish.
    """
    width, height = camera.size
    step = 1.0 / camera.scale
    colours = np.array([palette.MAP_UNKNOWN, palette.MAP_FREE, palette.MAP_OCCUPIED], dtype=np.uint8)
    state = np.zeros((height, width), dtype=np.uint8)
    cells = np.where(grid.occupied, 2, np.where(grid.free, 1, 0)).astype(np.uint8)
    T_map_world = inverse(T_world_map)
    for dx, dy in ((-0.25, -0.25), (0.25, -0.25), (-0.25, 0.25), (0.25, 0.25)):
        corner = np.array(
            [camera.centre[0] + (0.5 - width / 2 + dx) * step, camera.centre[1] - (0.5 - height / 2 + dy) * step, 0.0]
        )
        x0, y0, theta = compose(T_map_world, corner)
        along = np.arange(width) * step
        down = np.arange(height)[:, None] * step
        cos, sin = np.cos(theta), np.sin(theta)
        cols = np.floor((x0 + cos * along + sin * down - grid.origin[0]) / grid.resolution).astype(np.intp)
        rows = np.floor((y0 + sin * along - cos * down - grid.origin[1]) / grid.resolution).astype(np.intp)
        inside = (cols >= 0) & (cols < cells.shape[1]) & (rows >= 0) & (rows < cells.shape[0])
        sampled = cells[np.where(inside, rows, 0), np.where(inside, cols, 0)]
        state = np.maximum(state, np.where(inside, sampled, 0))
    return colours[state]
