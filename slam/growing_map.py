"""The map that a robot uses while it drives: each new scan is added to what is drawn already."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .grid import GridConfig, OccupancyGrid
from .occupancy_map import OccupancyMap
from .scan import LaserScan

Array = NDArray[np.float64]

LONGEST_RAY_M = 20.0
"""Longer returns do not enter the growing map [m]."""


class GrowingMap:
    """An occupancy grid that takes one scan at a time, which is much cheaper than drawing all scans anew.

    A scan stays where it was drawn until the SLAM engine has moved one of the earlier scans by more than a cell; then
    everything is drawn anew.

    Args:
        resolution: Side of a cell [m].
    """

    def __init__(self, resolution: float = 0.05) -> None:
        self._config = GridConfig(resolution=resolution, max_range=LONGEST_RAY_M, clear_no_return=True)
        self._numbers = np.zeros(0, dtype=np.int64)  # which scans are drawn ...
        self._poses = np.zeros((0, 3))  # ... and where each of them was drawn
        self._grid = OccupancyGrid(self._config)
        self._map: OccupancyMap | None = None

    def write(self, scan: LaserScan, pose: Array) -> None:
        """Draw a scan for good at its pose (3,) T_map_robot, which is never corrected later."""
        self._map = None
        self._grid.write(pose, scan)

    def follow(self, poses: Array, numbers: Sequence[int], scans: Sequence[LaserScan]) -> None:
        """Draw the scans that are new; draw all of them anew where an old one has moved by more than a cell.

        Args:
            poses: (n, 3) T_map_robot of the scans that a SLAM engine keeps now.
            numbers: (n,) which scan each of them is, ascending. A scan that is kept no longer is forgotten; what it
                drew stays until everything is drawn anew.
            scans: The n scans.
        """
        self._map = None
        wanted = np.asarray(numbers, dtype=np.int64)
        drawn = self._poses[np.isin(self._numbers, wanted)]
        old = len(drawn)
        moved = np.abs(poses[:old, :2] - drawn[:, :2]).max(initial=0.0)
        if moved > self._config.resolution:
            self._grid, drawn, old = OccupancyGrid(self._config), drawn[:0], 0
        for pose, scan in zip(poses[old:], scans[old:], strict=True):
            self._grid.write(pose, scan)
        self._numbers, self._poses = wanted, np.concatenate((drawn, poses[old:]))

    @property
    def map(self) -> OccupancyMap:
        """The map so far; the same object until more is drawn, so it must not be written to."""
        if self._map is None:
            self._map = self._grid.to_map()
        return self._map
