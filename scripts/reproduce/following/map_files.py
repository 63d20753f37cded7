"""Occupancy maps and trajectories between cells: npz files."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ....slam.files.output import replacing
from ....slam.occupancy_map import OccupancyMap

Array = NDArray[np.float64]


def save_map(path: Path, grid: OccupancyMap, trajectory: Array | None = None) -> None:
    """Write a map, and the trajectory (n, 3) it was drawn from, to `path` (.npz)."""
    with replacing(path) as temporary:
        np.savez_compressed(
            temporary,
            probability=grid.probability,
            resolution=np.array(grid.resolution),
            origin=np.array(grid.origin),
            thresholds=np.array([grid.occupied_threshold, grid.free_threshold]),
            trajectory=np.empty((0, 3)) if trajectory is None else trajectory,
        )


def load_map(path: Path) -> tuple[OccupancyMap, Array]:
    """Return the map and the trajectory that `save_map` wrote."""
    with np.load(path, allow_pickle=False) as data:
        x, y = (float(value) for value in data["origin"])
        occupied, free = (float(value) for value in data["thresholds"])
        grid = OccupancyMap(data["probability"], float(data["resolution"]), (x, y), occupied, free)
        return grid, data["trajectory"]
