"""What map the robot believes in: the mapper's own, or immobile area drawn on the mapper's poses."""

from array import array
from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ...perception.immobile.localization import ImmobileLocalization
from ...perception.immobile.mapper import ImmobileMapper, ImmobileMapperConfig
from ...perception.immobile.view import CameraView
from ...perception.people_filter import FilteredScan
from ...slam.growing_map import LONGEST_RAY_M
from ...slam.immobile.layers import LayersConfig
from ...slam.occupancy_map import OccupancyMap
from ...slam.pose_log import PoseLog
from .mappers import Mapper

Array = NDArray[np.float64]

_PERSON = 0.9  # likelihood that a return which was taken out is a person's
_REDRAW_S = 0.45


class Drawing(Protocol):
    """Chooses, or draws, the map that the robot believes in."""

    def update(self, mapper: Mapper, filtered_scan: FilteredScan, views: Sequence[CameraView]) -> OccupancyMap:
        """Take a scan, and the camera's views that have become ready by now.

        Returns:
            The map on the poses of `mapper`.
        """
        ...


class OwnDrawing:
    """The mapper's own occupancy map."""

    def update(self, mapper: Mapper, filtered_scan: FilteredScan, views: Sequence[CameraView]) -> OccupancyMap:
        """Return the mapper's map."""
        return mapper.map


class ImmobileDrawing:
    """Immobile area by laser and, if there is one, camera; drawn anew when SLAM has moved an earlier scan by a cell.

    Args:
        laser_height: Height of the laser's plane [m].
        redrawable: Whether the mapper may come to believe that the robot was elsewhere.
    """

    def __init__(self, laser_height: float, redrawable: bool = False) -> None:
        grid = LayersConfig(laser_height=laser_height, max_range=LONGEST_RAY_M, clear_no_return=True)
        self.mapper = ImmobileMapper(ImmobileMapperConfig(grid=grid), redrawable)
        self._map = self.mapper.grid.to_map()
        self._drawn_s = -np.inf
        self._times, self._poses = array("d"), PoseLog()  # when, and where, each scan was drawn

    def update(self, mapper: Mapper, filtered_scan: FilteredScan, views: Sequence[CameraView]) -> OccupancyMap:
        """Write the scan, and the views; return the map, drawn anew about twice a second."""
        self.mapper.add_scan(mapper.pose, filtered_scan.scan, np.where(filtered_scan.removed, _PERSON, 0.0))
        self._times.append(filtered_scan.scan.time_s)
        self._poses.append(mapper.pose)
        for view in views:
            self.mapper.add_view(view)
        if filtered_scan.scan.time_s - self._drawn_s > _REDRAW_S:
            self._correct(mapper)
            self._map, self._drawn_s = self.mapper.grid.to_map(), filtered_scan.scan.time_s
        return self._map

    def _correct(self, mapper: Mapper) -> None:
        """Draw everything anew, if the mapper has revised where the robot was."""
        path = mapper.revised()
        if path is None or len(path) != len(self._times):
            return
        moved = np.abs(path[:, :2] - self._poses.array()[:, :2]).max(initial=0.0)
        if moved > self.mapper.config.grid.resolution:
            self.mapper.redraw(np.array(self._times), path)
            self._poses = PoseLog.of(path)


class ImmobileMapLocalization:
    """A mapper that finds the robot on the immobile map which `ImmobileDrawing` draws: SLAM by that map alone.

    Args:
        drawn: What draws the map.
    """

    def __init__(self, drawn: ImmobileMapper) -> None:
        self._drawn, self._localization = drawn, ImmobileLocalization()
        self._pose = np.zeros(3)

    def update(self, odometry: Array, filtered_scan: FilteredScan) -> None:
        """Take one scan, with what is known of its people, and its odometry pose (3,)."""
        people = np.where(filtered_scan.removed, _PERSON, 0.0)
        self._pose = self._localization.locate(self._drawn.grid, odometry, filtered_scan.scan, people)

    @property
    def map(self) -> OccupancyMap:
        """The map so far."""
        return self._drawn.grid.to_map()

    @property
    def pose(self) -> Array:
        """(3,) T_map_robot."""
        return self._pose

    def revised(self) -> None:
        """Return None: no loop is closed."""
