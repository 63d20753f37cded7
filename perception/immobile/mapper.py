"""Laser and camera write one immobile-area map (Zhang et al. 2019, sections 2 and 4)."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...slam.bounds import check_numbers, check_positive, checked_pose
from ...slam.errors import InputError
from ...slam.geometry import compose, inverse, transform_points
from ...slam.immobile.grid import PoseHistory, moving_lambda, still_lambda
from ...slam.immobile.layers import ImmobileLayers, LayersConfig
from ...slam.scan import LaserScan
from ..legs.clusters import cluster_scan
from ..rgbd.planes import Surface
from .places import Places
from .view import CameraView
from .written import WrittenObservations, WrittenScan, WrittenView

Array = NDArray[np.float64]

_BODY = (0.5, 1.6)  # heights where a body would be seen [m]
_BODY_M = 0.4  # so wide a place is all in the picture [m]
_LEAST_POINTS = 40
_RELIABLE_M = (1.5, 5.0)  # nearer or farther people are missed too often to say that nobody is there
_LONGEST_LOOK_S = 1.0


@dataclass(frozen=True, kw_only=True)
class ImmobileMapperConfig:
    """Parameters of `ImmobileMapper`.

    Attributes:
        grid: The grid.
        person_radius: Returns this near to where somebody was recognised are theirs [m].
        body_radius: Their bodies reach this far [m].
        least_likely: Somebody less likely than this is not remembered, in [0, 1].
        doubt_s: Where the camera sees something but nobody, somebody remembered is half as likely after so long [s].
        recognised: Likelihood that a return stays that comes from where the camera recognised a wall or another plane,
            in [0, 1].
        empty: Cells with log-odds below this, and all around them, were empty: what stands there now has come.
        appeared_share: Share of an object's points in such cells from which on it has come, in [0, 1].
        settles_s: What has come and stood still for so long, and is nobody known, counts as a thing [s].
        largest: Objects wider than this are parts of the building [m].
    """

    grid: LayersConfig = field(default_factory=LayersConfig)
    person_radius: float = 0.35
    body_radius: float = 0.25
    least_likely: float = 0.5
    doubt_s: float = 2.0
    recognised: float = 1.0
    empty: float = -1.5
    appeared_share: float = 0.7
    largest: float = 1.5
    settles_s: float = 20.0

    def __post_init__(self) -> None:
        check_numbers(self)
        check_positive(self, "person_radius", "body_radius", "largest", "settles_s", "doubt_s")
        for name in ("least_likely", "recognised", "appeared_share"):
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
        redrawable: Whether what was written is kept, so that the map can be drawn anew by `redraw`.
    """

    def __init__(self, config: ImmobileMapperConfig | None = None, redrawable: bool = False) -> None:
        self.config = config or ImmobileMapperConfig()
        self._written = WrittenObservations() if redrawable else None
        self.grid = ImmobileLayers(self.config.grid)
        self.people = Places(self.config.person_radius)
        self.came = Places(self.config.person_radius, self.config.settles_s)
        self._poses = PoseHistory()
        self._looked_s = -np.inf

    def add_scan(self, T_map_robot: ArrayLike, scan: LaserScan, people: ArrayLike | float = 0.0) -> None:
        """Write one scan.

        Args:
            T_map_robot: (3,) pose of the robot at the scan.
            scan: The scan, people and all.
            people: (N,) or one: how likely each beam met a person, as legs and tracks say, in [0, 1].
        """
        pose = checked_pose(T_map_robot, "T_map_robot")
        self._poses.add(scan.time_s, pose)
        T_map_lidar = compose(pose, scan.T_robot_lidar)
        self._note_what_came(T_map_lidar, scan)
        moves = np.maximum(self.people.update(pose, scan), self.came.update(pose, scan))
        moves = np.maximum(moves, people)
        stays = self.grid.is_recognised(T_map_lidar, scan.beam_points)
        lambdas = np.where(stays, still_lambda(self.config.recognised), moving_lambda(moves))
        self._write(WrittenScan(scan, lambdas), pose)

    def add_view(self, view: CameraView) -> None:
        """Write what the camera saw, where the robot was at the exposure.

        Raises:
            InputError: If no scan was taken around that time.
        """
        T_map_camera = compose(self._poses.at(view.time_s), view.T_robot_camera)
        self._remember_people(T_map_camera, view)
        moves = np.where(self._objects_that_came(T_map_camera, view), 1.0, self._beside_people(T_map_camera, view))
        lambdas = np.where(moves > 0.0, np.fmin(view.lambdas, moving_lambda(moves)), view.lambdas)
        sure = view.people.likelihood >= self.config.least_likely
        written = WrittenView(
            view=view,
            lambdas=lambdas,
            level=view.surface == Surface.TOP,
            people=view.people.positions[sure],
            people_lambdas=np.asarray(moving_lambda(view.people.likelihood[sure])),
            body_radius=self.config.body_radius,
        )
        self._write(written, self._poses.at(view.time_s))

    def redraw(self, times_s: ArrayLike, poses: ArrayLike) -> None:
        """Draw the map anew, because the robot is now believed to have been elsewhere, as when SLAM closes a loop.

        What was recognised stays what it was. Observations that many newer ones from the same place have superseded
        are left out.

        Args:
            times_s: (n,) rising times [s]; the last is that of the last scan.
            poses: (n, 3) T_map_robot at these times.

        Raises:
            InputError: If the mapper is not `redrawable`, or nothing was written yet.
        """
        if self._written is None or not len(self._written):
            raise InputError("only a map that was made `redrawable`, and written to, can be drawn anew")
        times, path = np.asarray(times_s, dtype=np.float64), np.asarray(poses, dtype=np.float64)
        T_new_old = compose(path[-1], inverse(self._poses.newest))
        self.grid = ImmobileLayers(self.config.grid)
        self._written.draw(self.grid, times, path)
        self._poses.replace(times, path)
        self.people.transform(T_new_old)
        self.came.transform(T_new_old)

    def _write(self, observation: WrittenScan | WrittenView, T_map_robot: Array) -> None:
        observation.write(self.grid, T_map_robot)
        if self._written is not None:
            self._written.add(observation, T_map_robot)

    def _remember_people(self, T_map_camera: Array, view: CameraView) -> None:
        """Remember whom the view shows; doubt those of whom it shows nothing."""
        looked_s = min(view.time_s - self._looked_s, _LONGEST_LOOK_S)
        self._looked_s = view.time_s
        share = 0.5 ** (looked_s / self.config.doubt_s)
        self.people.doubt(self._places_without_people(T_map_camera, view), share, self.config.least_likely)
        sure = view.people.likelihood >= self.config.least_likely
        places = transform_points(self._poses.at(view.time_s), view.people.positions[sure])
        # somebody cut by the picture's edge is not where the rest of them is seen
        well = self._whole(T_map_camera, view, places) | (self.people.likelihood(places) == 0.0)
        self.people.add(places[well], view.people.likelihood[sure][well], view.time_s)

    def _beside_people(self, T_map_camera: Array, view: CameraView) -> Array:
        """Return (n,) how likely each point of a view is the ragged edge of somebody; 0 for what was recognised."""
        found = np.zeros(len(view.points))
        unknown = (view.surface == Surface.OTHER) & (view.person < 0)
        found[unknown] = self.people.likelihood(transform_points(T_map_camera, view.points[unknown, :2]))
        return found

    def _note_what_came(self, T_map_lidar: Array, scan: LaserScan) -> None:
        """Remember where the scan met objects that were not there before."""
        clusters, height = cluster_scan(scan), self.config.grid.laser_height
        empty = self.grid.log_odds_around(T_map_lidar, clusters.points, height) < self.config.empty
        places = []
        for start, end in zip(clusters.start, clusters.end, strict=True):
            piece = clusters.points[start:end]
            if empty[start:end].mean() >= self.config.appeared_share and self._is_small(piece):
                places += self._along(piece)
        if places:
            self.came.add(transform_points(T_map_lidar, np.array(places)), np.ones(len(places)), scan.time_s)

    def _along(self, piece: Array) -> list[Array]:
        """Return the middles of parts of a `piece` (n, 2), none longer than the radius of a place."""
        parts = int(np.ceil(np.hypot(*np.ptp(piece, axis=0)) / self.config.person_radius))
        return [part.mean(axis=0) for part in np.array_split(piece, min(max(parts, 1), len(piece)))]

    def _objects_that_came(self, T_map_camera: Array, view: CameraView) -> NDArray[np.bool_]:
        """Return (n,) whether each point of a view belongs to an object that was not there before, by the laser."""
        found = np.zeros(len(view.points), dtype=bool)
        inside = np.flatnonzero(view.cluster >= 0)
        places = self.came.moving(view.time_s)
        if not len(inside) or not len(places):
            return found
        where = transform_points(T_map_camera, view.points[inside, :2])
        near = (np.hypot(*(where[:, None] - places).transpose(2, 0, 1)) < self.config.person_radius).any(axis=1)
        of = view.cluster[inside]
        share = np.bincount(of, near) / np.maximum(np.bincount(of), 1)
        found[inside] = share[of] >= self.config.appeared_share
        return found

    def _places_without_people(self, T_map_camera: Array, view: CameraView) -> Array:
        """Return (n, 2) the remembered places of people, map frame [m], where the view shows other things instead.

        A person at the edge of the picture is only partly in it, and may well not be recognised.
        """
        places = self.people.moving(view.time_s)
        if not len(places):
            return places
        body = (view.points[:, 2] > _BODY[0]) & (view.points[:, 2] < _BODY[1])
        points = transform_points(T_map_camera, view.points[body, :2])
        near = np.hypot(*(points[:, None] - places).transpose(2, 0, 1)) < self.config.body_radius
        nobody = ~(near & (view.person[body] >= 0)[:, None]).any(axis=0)
        away = np.hypot(*(places - T_map_camera[:2]).T)
        close = self._whole(T_map_camera, view, places) & (away > _RELIABLE_M[0]) & (away < _RELIABLE_M[1])
        return places[nobody & close & (near.sum(axis=0) >= _LEAST_POINTS)]

    def _whole(self, T_map_camera: Array, view: CameraView, places: Array) -> NDArray[np.bool_]:
        """Return (n,) whether somebody at each of `places` (n, 2), map frame [m], is all within the picture's sides."""
        x, y = transform_points(inverse(T_map_camera), places).T
        widest = np.abs(np.arctan2(view.points[:, 1], view.points[:, 0])).max(initial=0.0)
        return np.abs(np.arctan2(y, x)) + np.arctan2(_BODY_M, np.hypot(x, y)) < widest

    def _is_small(self, points: Array) -> bool:
        return float(np.hypot(*np.ptp(points, axis=0))) <= self.config.largest
