"""The part of the map around the robot, turned with it."""

import numpy as np
from numpy.typing import NDArray

from ...slam.geometry import transform_points
from ...slam.occupancy_map import OccupancyMap

UNKNOWN = 0.5
"""What a cell reads of which nothing is known; a free one reads 0, an occupied one 1."""


class MapPatch:
    """Samples a square of cells centred on the robot.

    Cell [i, j] lies at x = (i + 0.5 - cells / 2) * resolution ahead of the robot and y likewise to its left.
    """

    def __init__(self, cells: int, resolution: float) -> None:
        self._cells = cells
        places = (np.arange(cells) + 0.5 - cells / 2.0) * resolution
        x, y = np.meshgrid(places, places, indexing="ij")
        self._centres_robot = np.stack((x.ravel(), y.ravel()), axis=1)

    def around(self, grid: OccupancyMap, T_map_robot: NDArray[np.float64]) -> NDArray[np.float32]:
        """Return (cells, cells) of `grid` around the robot at `T_map_robot` (3,)."""
        offset = transform_points(T_map_robot, self._centres_robot) - grid.origin
        cells = np.floor(offset / grid.resolution).astype(np.intp)
        cols, rows = cells[:, 0], cells[:, 1]
        inside = (cols >= 0) & (cols < grid.probability.shape[1]) & (rows >= 0) & (rows < grid.probability.shape[0])
        patch = np.full(len(cells), UNKNOWN, dtype=np.float32)
        known = grid.probability[rows[inside], cols[inside]]
        occupied, free = known > grid.occupied_threshold, known < grid.free_threshold
        patch[inside] = np.where(occupied, 1.0, np.where(free, 0.0, UNKNOWN))
        return patch.reshape(self._cells, self._cells)
