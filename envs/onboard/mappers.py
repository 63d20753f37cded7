"""Who builds the map that the robot believes in."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ...perception.people_filter import FilteredScan
from ...slam.engine import SlamEngine
from ...slam.occupancy_map import OccupancyMap

Array = NDArray[np.float64]


class Mapper(Protocol):
    """A map and the robot's pose in it."""

    def update(self, odometry: Array, filtered_scan: FilteredScan) -> None:
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

    def revised(self) -> Array | None:
        """Return (n, 3) T_map_robot of all scans by what is known now; None: a pose once told is never revised."""
        ...


class SlamMapper:
    """A SLAM engine and its live map."""

    def __init__(self, engine: SlamEngine) -> None:
        self.engine = engine
        self._map: OccupancyMap | None = None

    def update(self, odometry: Array, filtered_scan: FilteredScan) -> None:
        """Take one scan, without its people, and its odometry pose (3,)."""
        if self.engine.update(odometry, filtered_scan.without_people).integrated:
            self._map = None

    @property
    def map(self) -> OccupancyMap:
        """The map so far; not to be written to."""
        if self._map is None:
            self._map = self.engine.live_map()
        return self._map

    @property
    def pose(self) -> Array:
        """(3,) T_map_robot."""
        return self.engine.pose

    def revised(self) -> Array:
        """Return (n, 3) T_map_robot of all scans by what is known now."""
        return self.engine.trajectory()


class NoMapper:
    """Builds nothing."""

    def __init__(self) -> None:
        self._map = OccupancyMap(np.full((1, 1), np.nan, dtype=np.float32), 1.0, (0.0, 0.0))
        self._pose = np.full(3, np.nan)

    def update(self, odometry: Array, filtered_scan: FilteredScan) -> None:
        """Ignore the scan."""

    @property
    def map(self) -> OccupancyMap:
        """One unknown cell."""
        return self._map

    @property
    def pose(self) -> Array:
        """(3,) NaN."""
        return self._pose

    def revised(self) -> None:
        """Return None: there are no poses."""
