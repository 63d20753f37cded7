"""Who builds the map that the robot believes in."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ..perception.people_filter import SiftedScan
from ..slam.engine import SlamEngine
from ..slam.grid import GridConfig, OccupancyGrid
from ..slam.occupancy_map import OccupancyMap
from ..slam.scan import LaserScan

Array = NDArray[np.float64]

LONGEST_RAY_M = 20.0
"""Longer returns do not enter the growing map [m]."""


class Mapper(Protocol):
    """A map and the robot's pose in it."""

    def update(self, odometry: Array, sifted: SiftedScan) -> None:
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
        self._drawn = np.zeros((0, 3))
        self._grid = OccupancyGrid(self._config)
        self._map: OccupancyMap | None = None

    def add(self, scan: LaserScan, path: Array) -> None:
        """Add a scan; `path` (n, 3) are the poses T_map_robot of all scans so far, this one's last."""
        self._scans.append(scan)
        self._map = None
        moved = np.abs(path[:-1, :2] - self._drawn[:, :2]).max(initial=0.0)
        if moved <= self._config.resolution:
            self._grid.write(path[-1], scan)
            self._drawn = np.vstack((self._drawn, path[-1]))
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

    def update(self, odometry: Array, sifted: SiftedScan) -> None:
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
        """(k, 3) T_map_robot of the integrated scans, by what is known now."""
        ...


class GraphMapper:
    """A graph SLAM engine, and the map that its scans draw where it believes them now."""

    def __init__(self, engine: GraphEngine) -> None:
        self.engine = engine
        self._growing = GrowingMap()

    def update(self, odometry: Array, sifted: SiftedScan) -> None:
        """Take one scan, without its people, and its odometry pose (3,)."""
        if self.engine.update(odometry, sifted.without_people).integrated:
            self._growing.add(sifted.without_people, self.engine.node_poses)

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

    def update(self, odometry: Array, sifted: SiftedScan) -> None:
        """Ignore the scan."""

    @property
    def map(self) -> OccupancyMap:
        """One unknown cell."""
        return self._map

    @property
    def pose(self) -> Array:
        """(3,) NaN."""
        return self._pose
