"""What map the robot believes in: the mapper's own, or immobile area drawn on the mapper's poses."""

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from ...perception.immobile.mapper import ImmobileMapper, ImmobileMapperConfig
from ...perception.immobile.view import CameraView
from ...perception.people_filter import FilteredScan
from ...slam.growing_map import LONGEST_RAY_M
from ...slam.immobile.layers import LayersConfig
from ...slam.occupancy_map import OccupancyMap
from .mappers import Mapper

_PERSON = 0.9
_REDRAW_S = 0.45


class Drawing(Protocol):
    """Chooses, or draws, the map that the robot believes in."""

    def update(self, mapper: Mapper, sifted: FilteredScan, views: Sequence[CameraView]) -> OccupancyMap:
        """Take a scan, and the camera's views that have become ready by now.

        Returns:
            The map on the poses of `mapper`.
        """
        ...


class OwnDrawing:
    """The mapper's own occupancy map."""

    def update(self, mapper: Mapper, sifted: FilteredScan, views: Sequence[CameraView]) -> OccupancyMap:
        """Return the mapper's map."""
        return mapper.map


class ImmobileDrawing:
    """Immobile area by laser and, if there is one, camera.

    Args:
        laser_height: Height of the laser's plane [m].
    """

    def __init__(self, laser_height: float) -> None:
        grid = LayersConfig(laser_height=laser_height, max_range=LONGEST_RAY_M, clear_no_return=True)
        self.mapper = ImmobileMapper(ImmobileMapperConfig(grid=grid))
        self._map = self.mapper.grid.to_map()
        self._drawn_s = -np.inf

    def update(self, mapper: Mapper, sifted: FilteredScan, views: Sequence[CameraView]) -> OccupancyMap:
        """Write the scan, and the views; return the map, drawn anew about twice a second."""
        self.mapper.add_scan(mapper.pose, sifted.scan, np.where(sifted.removed, _PERSON, 0.0))
        for view in views:
            self.mapper.add_view(view)
        if sifted.scan.time_s - self._drawn_s > _REDRAW_S:
            self._map, self._drawn_s = self.mapper.grid.to_map(), sifted.scan.time_s
        return self._map
