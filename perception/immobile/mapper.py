"""Laser and camera write one immobile-area map (Zhang et al. 2019, sections 2 and 4)."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...slam.errors import InputError
from ...slam.geometry import compose, transform_points
from ...slam.immobile_grid import UNKNOWN, PoseHistory, moving_lambda
from ...slam.immobile_layers import ImmobileLayers, LayersConfig
from ...slam.scan import LaserScan
from ..legs.clusters import cluster_scan
from ..rgbd.planes import Surface
from .places import PeoplePlaces
from .view import View

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class ImmobileMapperConfig:
    """Parameters of `ImmobileMapper`.

    Attributes:
        grid: The grid.
        person_radius: Returns this near to where somebody was recognised are theirs [m].
        least_likely: Somebody less likely than this is not remembered, in [0, 1].
        empty: Cells with log-odds below this, and all around them, were empty: what stands there now has come.
        appeared_share: Share of an object's points in such cells from which on it has come, in [0, 1].
        largest: Objects wider than this are parts of the building [m].
    """

    grid: LayersConfig = field(default_factory=LayersConfig)
    person_radius: float = 0.35
    least_likely: float = 0.5
    empty: float = -1.5
    appeared_share: float = 0.7
    largest: float = 1.5

    def __post_init__(self) -> None:
        for name in ("person_radius", "largest"):
            if not getattr(self, name) > 0.0:
                raise InputError(f"`{name}` must be positive [m], got {getattr(self, name)}")
        for name in ("least_likely", "appeared_share"):
            if not 0.0 <= getattr(self, name) <= 1.0:
                raise InputError(f"`{name}` must be in [0, 1], got {getattr(self, name)}")
        if not self.empty < 0.0:
            raise InputError(f"`empty` must be negative, got {self.empty}")


class ImmobileMapper:
    """Builds the map: every scan at once, views whenever they are ready.

    What is recognised sets lambda: people by likelihood, walls and other planes by theirs; what has come into an empty
    place is moving; the rest is unknown.

    Args:
        config: Parameters.
    """

    def __init__(self, config: ImmobileMapperConfig | None = None) -> None:
        self.config = config or ImmobileMapperConfig()
        self.grid = ImmobileLayers(self.config.grid)
        self.people = PeoplePlaces(self.config.person_radius)
        self._poses = PoseHistory()

    def add_scan(self, T_map_robot: ArrayLike, scan: LaserScan, people: ArrayLike | float = 0.0) -> None:
        """Write one scan.

        Args:
            T_map_robot: (3,) pose of the robot at the scan.
            scan: The scan, people and all.
            people: (N,) or one: how likely each beam met a person, as legs and tracks say, in [0, 1].
        """
        pose = np.asarray(T_map_robot, dtype=np.float64)
        self._poses.add(scan.time_s, pose)
        somebody = np.maximum(self.people.update(pose, scan), people)
        lambdas = np.where(self._has_come(pose, scan), moving_lambda(1.0), UNKNOWN)
        self.grid.write(pose, scan, np.where(somebody > 0.0, np.minimum(lambdas, moving_lambda(somebody)), lambdas))

    def add_view(self, view: View) -> None:
        """Write what the camera saw, where the robot was at the exposure.

        Raises:
            InputError: If no scan was taken around that time.
        """
        T_map_camera = compose(self._poses.at(view.time_s), view.T_robot_camera)
        lambdas = np.where(self._objects_have_come(T_map_camera, view), moving_lambda(1.0), view.lambdas)
        self.grid.write_view(T_map_camera, view.camera_height, view.points, lambdas, view.above)
        sure = view.people.likelihood >= self.config.least_likely
        places = transform_points(self._poses.at(view.time_s), view.people.positions[sure])
        self.people.add(places, view.people.likelihood[sure])

    def _has_come(self, pose: Array, scan: LaserScan) -> NDArray[np.bool_]:
        """Return (N,) whether each beam met an object that was not there before."""
        clusters, met = cluster_scan(scan), np.zeros(len(scan), dtype=bool)
        T_map_lidar = compose(pose, scan.T_robot_lidar)
        empty = (
            self.grid.log_odds_around(T_map_lidar, clusters.points, self.config.grid.laser_height) < self.config.empty
        )
        for start, end in zip(clusters.start, clusters.end, strict=True):
            piece = clusters.points[start:end]
            if empty[start:end].mean() >= self.config.appeared_share and self._is_small(piece):
                met[clusters.beams[start:end]] = True
        return met

    def _objects_have_come(self, T_map_camera: Array, view: View) -> NDArray[np.bool_]:
        """Return (n,) whether each point of a view belongs to an object that was not there before."""
        come = np.zeros(len(view.points), dtype=bool)
        inside = np.flatnonzero((view.cluster >= 0) & (view.surface != Surface.TOP))
        if not len(inside):
            return come
        where = view.points[inside]
        empty = self.grid.log_odds_around(T_map_camera, where[:, :2], where[:, 2]) < self.config.empty
        of = view.cluster[inside]
        share = np.bincount(of, empty) / np.maximum(np.bincount(of), 1)
        for k in np.flatnonzero(share >= self.config.appeared_share):
            mine = inside[of == k]
            come[mine] = self._is_small(view.points[mine, :2])
        return come

    def _is_small(self, points: Array) -> bool:
        return float(np.hypot(*np.ptp(points, axis=0))) <= self.config.largest
