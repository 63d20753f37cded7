"""SLAM that draws the immobile-area map: on the poses of an engine, or by the map itself (Zhang et al. 2019)."""

from array import array
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...slam.engine import SlamEngine, SlamUpdate
from ...slam.errors import InputError
from ...slam.geometry import compose, inverse, transform_points
from ...slam.occupancy_map import OccupancyMap
from ...slam.pose_log import PoseLog
from ...slam.scan import LaserScan
from ..people_filter import FilteredScan, PeopleFilter, PeopleFilterConfig, near_points
from .localization import ImmobileLocalization, ImmobileLocalizationConfig
from .mapper import ImmobileMapper, ImmobileMapperConfig
from .view import CameraView

Array = NDArray[np.float64]

_LIVE_S = 0.45  # between two drawings of the map for those who look on


@dataclass(frozen=True, kw_only=True)
class ImmobileSlamConfig:
    """Configuration of `ImmobileSlam`.

    Attributes:
        mapper: Of the map.
        people: Of what tracks people in the scans.
        localization: Of the localization by the map itself.
        engine: Of the engine that localizes instead; None: the map does.
    """

    mapper: ImmobileMapperConfig = field(default_factory=ImmobileMapperConfig)
    people: PeopleFilterConfig = field(default_factory=PeopleFilterConfig)
    localization: ImmobileLocalizationConfig = field(default_factory=ImmobileLocalizationConfig)
    engine: Any = None


class ImmobileSlam:
    """A `SlamEngine` whose map is that of immobile area, by laser and camera.

    An engine that localizes gets the scans without the returns on people; where it comes to believe in the end that
    the robot was elsewhere, the map is drawn anew.

    Args:
        views: What the camera saw, in the order of time; taken when the scan after it comes.
        config: Configuration; its `engine` is not looked at.
        engine: Says where the robot is; None: each scan is matched on the map that those before it drew.
    """

    def __init__(
        self,
        views: Iterable[CameraView] = (),
        config: ImmobileSlamConfig | None = None,
        engine: SlamEngine | None = None,
    ) -> None:
        self._config, self._engine = config or ImmobileSlamConfig(), engine
        self._views: Iterator[CameraView] = iter(views)
        self._next: CameraView | None = None
        self._filter = PeopleFilter(self._config.people)
        self._localization = ImmobileLocalization(self._config.localization)
        self.mapper = ImmobileMapper(self._config.mapper, redrawable=engine is not None)
        self._times, self._poses = array("d"), PoseLog()
        self._live: tuple[float, OccupancyMap] | None = None
        self.views_written = 0
        """How many views are in the map."""

    @property
    def config(self) -> ImmobileSlamConfig:
        """The configuration, with that of the engine."""
        engine = None if self._engine is None else self._engine.config
        return ImmobileSlamConfig(
            mapper=self._config.mapper,
            people=self._config.people,
            localization=self._config.localization,
            engine=engine,
        )

    @property
    def pose(self) -> Array:
        """(3,) T_map_robot, the best estimate now."""
        if self._engine is not None:
            return self._engine.pose
        return self._poses[-1] if len(self._poses) else np.zeros(3)

    def update(self, odometry: ArrayLike, scan: LaserScan) -> SlamUpdate:
        """Take one scan and the robot's odometry pose T_odom_robot (3,) at that time.

        Raises:
            InputError: If its time is not later than that of the scan before.
        """
        if self._times and not scan.time_s > self._times[-1]:
            raise InputError(
                f"the immobile-area map needs scans whose times increase, got {scan.time_s} s after {self._times[-1]} s"
            )
        filtered = self._filter.update(scan, odometry)
        people = beams_on_people(filtered, self._filter.config.removal.zeta)
        if self._engine is None:
            pose = self._localization.locate(self.mapper.grid, odometry, scan, people)
            update = SlamUpdate(pose=pose, integrated=True, diagnostics={})
        else:
            update = self._engine.update(odometry, filtered.without_people)
        self.mapper.add_scan(update.pose, scan, people)
        self._times.append(scan.time_s)
        self._poses.append(update.pose)
        self._look(scan.time_s)
        return update

    def _look(self, now_s: float) -> None:
        """Write the views up to now; those of before the first scan are nowhere."""
        while True:
            self._next = self._next or next(self._views, None)
            if self._next is None or self._next.time_s > now_s:
                return
            view, self._next = self._next, None
            if view.time_s >= self._times[0] and view.time_s > now_s - 1.0:
                self.mapper.add_view(view)
                self.views_written += 1

    def finish(self) -> None:
        """Improve the engine's poses, and draw the map anew where they moved by a cell or more."""
        if self._engine is None or not len(self._poses):
            return
        self._engine.finish()
        path = self._engine.trajectory()
        moved = np.abs(path[:, :2] - self._poses.array()[:, :2]).max(initial=0.0)
        if moved > self._config.mapper.grid.resolution:
            self.mapper.redraw(np.array(self._times), path)
            self._poses, self._live = PoseLog.of(path), None

    def trajectory(self) -> Array:
        """Return (n, 3) T_map_robot for every scan so far, by what is known now."""
        return self._poses.array() if self._engine is None else self._engine.trajectory()

    def map(self) -> OccupancyMap:
        """Return the map as it is now."""
        return self.mapper.grid.to_map()

    def map_at(self, resolution: float) -> OccupancyMap:
        """Return the map as it is now.

        Raises:
            InputError: If `resolution` is not that of its grid, which keeps no scans.
        """
        own = self._config.mapper.grid.resolution
        if abs(resolution - own) > 1e-9:
            raise InputError(f"the immobile-area map is drawn with cells of {own} m, got {resolution} m")
        return self.map()

    def live_map(self) -> OccupancyMap:
        """Return the map, drawn twice a second at most."""
        now_s = self._times[-1] if self._times else 0.0
        if self._live is None or now_s - self._live[0] > _LIVE_S:
            self._live = (now_s, self.map())
        return self._live[1]


def beams_on_people(filtered: FilteredScan, near: float) -> Array:
    """Return (N,) how likely each beam met somebody who is tracked: a place or a leg no farther than `near` [m]."""
    scan, people = filtered.scan, filtered.people
    found = np.zeros(len(scan))
    T_lidar_odom = inverse(compose(filtered.odometry, scan.T_robot_lidar))
    for row in range(len(people)):
        places = np.concatenate((people.positions[row][None], people.legs[row]))
        mine = near_points(scan, transform_points(T_lidar_odom, places), near)
        found[mine] = np.maximum(found[mine], people.confidence[row])
    return found
