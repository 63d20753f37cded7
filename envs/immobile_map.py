"""What map the robot believes in: the mapper's own, or immobile area drawn on the mapper's poses."""

from collections import deque
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ..perception.immobile.mapper import ImmobileMapper, ImmobileMapperConfig
from ..perception.immobile.view import View, ViewMaker
from ..perception.rgbd.frame import RgbdFrame
from ..slam.immobile_layers import LayersConfig
from ..slam.occupancy_map import OccupancyMap
from ..slam.scan import LaserScan
from .mappers import LONGEST_RAY_M, Mapper

Array = NDArray[np.float64]

VIEW_DELAY_S = 0.3
"""Views are ready this long after their exposure [s]."""
_PERSON = 0.9
_REDRAW_S = 0.45


class Drawing(Protocol):
    """Chooses, or draws, the map that the robot believes in."""

    def update(self, mapper: Mapper, scan: LaserScan, near_people: NDArray[np.bool_]) -> OccupancyMap:
        """Take a scan and which of its beams (N,) met people; return the map on the poses of `mapper`."""
        ...

    def look(self, frames: tuple[RgbdFrame, ...]) -> None:
        """Take the camera's frames, oldest first."""
        ...


class OwnDrawing:
    """The mapper's own occupancy map."""

    def update(self, mapper: Mapper, scan: LaserScan, near_people: NDArray[np.bool_]) -> OccupancyMap:
        """Return the mapper's map."""
        return mapper.map

    def look(self, frames: tuple[RgbdFrame, ...]) -> None:
        """Ignore the frames."""


class ImmobileDrawing:
    """Immobile area by laser and, if there is one, camera.

    Args:
        laser_height: Height of the laser's plane [m].
        views: Makes views of frames.
    """

    def __init__(self, laser_height: float, views: ViewMaker) -> None:
        grid = LayersConfig(laser_height=laser_height, max_range=LONGEST_RAY_M, clear_no_return=True)
        self.mapper = ImmobileMapper(ImmobileMapperConfig(grid=grid))
        self._views = views
        self._waiting: deque[View] = deque()
        self._map = self.mapper.grid.to_map()
        self._drawn_s = -np.inf
        self._seen_s = -np.inf

    def update(self, mapper: Mapper, scan: LaserScan, near_people: NDArray[np.bool_]) -> OccupancyMap:
        """Write the scan, and the views that are ready; return the map, drawn anew about twice a second."""
        self.mapper.add_scan(mapper.pose, scan, np.where(near_people, _PERSON, 0.0))
        while self._waiting and self._waiting[0].time_s + VIEW_DELAY_S <= scan.time_s + 1e-9:
            self.mapper.add_view(self._waiting.popleft())
        if scan.time_s - self._drawn_s > _REDRAW_S:
            self._map, self._drawn_s = self.mapper.grid.to_map(), scan.time_s
        return self._map

    def look(self, frames: tuple[RgbdFrame, ...]) -> None:
        """Understand the latest frame, if it is new."""
        for frame in frames[-1:]:
            if frame.time_s > self._seen_s:
                self._seen_s = frame.time_s
                self._waiting.append(self._views.make(frame))
