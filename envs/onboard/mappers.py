"""Who builds the map that the robot believes in."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ...perception.people_filter import FilteredScan
from ...slam.engine import SlamEngine
from ...slam.grid import GridConfig, OccupancyGrid
from ...slam.occupancy_map import OccupancyMap
from ...slam.scan import LaserScan

Array = NDArray[np.float64]

LONGEST_RAY_M = 20.0
"""Longer returns do not enter the growing map [m]."""


class Mapper(Protocol):
    """A map and the robot's pose in it."""

    def update(self, odometry: Array, sifted: FilteredScan) -> None:
        """Take one scan, of which the map needs what is left without people, and its odometry pose (3,)."""
        ...

    @property
    def map(self) -> OccupancyMap:
        """The map so far; not to be written to."""
        ...

    @property
    def pose(self) -> Array:
        """(3,) T_map_robot; NaN without a map."""
        ...


class GrowingMap:
    """A map drawn scan by scan, and drawn anew when the poses of earlier scans are believed to be elsewhere."""

    def __init__(self, resolution: float = 0.05) -> None:
        self._config = GridConfig(resolution=resolution, max_range=LONGEST_RAY_M, clear_no_return=True)
        self._scans: list[LaserScan] = []
        self._numbers = np.zeros(0, dtype=np.int64)  # which scans they are
        self._drawn = np.zeros((0, 3))
        self._grid = OccupancyGrid(self._config)
        self._map: OccupancyMap | None = None

    def write(self, scan: LaserScan, pose: Array) -> None:
        """Draw a scan for good at its pose (3,) T_map_robot, which will not be believed to be elsewhere."""
        self._map = None
        self._grid.write(pose, scan)

    def add(self, scan: LaserScan, path: Array, numbers: Sequence[int]) -> None:
        """Draw a scan that may be believed to be elsewhere later.

        Args:
            scan: The scan.
            path: (n, 3) poses T_map_robot of the scans that count now, this one's last.
            numbers: (n,) which scan each of them is. One that counts no more is forgotten; what it drew stays until the
                map is drawn anew.
        """
        self._map = None
        wanted = np.asarray(numbers)
        kept = np.isin(self._numbers, wanted)
        self._scans = [old for old, stays in zip(self._scans, kept.tolist(), strict=True) if stays] + [replace(scan)]
        self._numbers, drawn = wanted, self._drawn[kept]
        moved = np.abs(path[:-1, :2] - drawn[:, :2]).max(initial=0.0)
        if moved <= self._config.resolution:
            self._grid.write(path[-1], scan)
            self._drawn = np.vstack((drawn, path[-1]))
            return
        self._grid = OccupancyGrid(self._config)
        for pose, old in zip(path, self._scans, strict=True):
            self._grid.write(pose, old)
        self._drawn = path.copy()

    @property
    def map(self) -> OccupancyMap:
        """The map so far."""
        if self._map is None:
            self._map = self._grid.to_map()
        return self._map


class ParticleEngine(SlamEngine, Protocol):
    """A SLAM engine whose best particle carries a map that is ready at any time."""

    def particle_map(self) -> OccupancyMap:
        """Return that map."""
        ...


class EngineMapper:
    """A SLAM engine and its best particle's map: what is drawn already, since drawing anew would stop the robot."""

    def __init__(self, engine: ParticleEngine) -> None:
        self.engine = engine
        self._map: OccupancyMap | None = None

    def update(self, odometry: Array, sifted: FilteredScan) -> None:
        """Take one scan, without its people, and its odometry pose (3,)."""
        if self.engine.update(odometry, sifted.without_people).integrated:
            self._map = None

    @property
    def map(self) -> OccupancyMap:
        """The map so far; not to be written to."""
        if self._map is None:
            self._map = self.engine.particle_map()
        return self._map

    @property
    def pose(self) -> Array:
        """(3,) T_map_robot."""
        return self.engine.pose


class GraphEngine(SlamEngine, Protocol):
    """A SLAM engine that keeps the poses of the scans in its map."""

    @property
    def node_poses(self) -> Array:
        """(k, 3) T_map_robot of the integrated scans that count, by what is known now."""
        ...

    @property
    def node_scans(self) -> list[int]:
        """The scan that each of them is, ascending."""
        ...


class GraphMapper:
    """A graph SLAM engine, and the map that its scans draw where it believes them now."""

    def __init__(self, engine: GraphEngine) -> None:
        self.engine = engine
        self._growing = GrowingMap()

    def update(self, odometry: Array, sifted: FilteredScan) -> None:
        """Take one scan, without its people, and its odometry pose (3,)."""
        if self.engine.update(odometry, sifted.without_people).integrated:
            self._growing.add(sifted.without_people, self.engine.node_poses, self.engine.node_scans)

    @property
    def map(self) -> OccupancyMap:
        """The map so far; not to be written to."""
        return self._growing.map

    @property
    def pose(self) -> Array:
        """(3,) T_map_robot."""
        return self.engine.pose


class NoMapper:
    """Builds nothing."""

    def __init__(self) -> None:
        self._map = OccupancyMap(np.full((1, 1), np.nan, dtype=np.float32), 1.0, (0.0, 0.0))
        self._pose = np.full(3, np.nan)

    def update(self, odometry: Array, sifted: FilteredScan) -> None:
        """Ignore the scan."""

    @property
    def map(self) -> OccupancyMap:
        """One unknown cell."""
        return self._map

    @property
    def pose(self) -> Array:
        """(3,) NaN."""
        return self._pose
