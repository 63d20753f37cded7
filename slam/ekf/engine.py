"""EKF-SLAM as an engine: cluster, associate, update, manage landmarks."""

import math
from dataclasses import fields
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import block_diag

from ..bounds import checked_pose
from ..engine import SlamUpdate
from ..errors import InputError
from ..geometry import between, compose
from ..grid import GridConfig, render_map
from ..growing_map import GrowingMap
from ..landmarks.clustering import Clusterer, clusterer_of_scans
from ..landmarks.landmark_map import LandmarkMap
from ..landmarks.objects import LandmarkSightings, SightingConfig, see_landmarks
from ..occupancy_map import OccupancyMap
from ..pose_log import PoseLog
from ..processes.blas import one_thread
from ..revisits import KeptScans
from ..scan import LaserScan
from ..settings import with_settings
from .association import Innovations, Pairs, compare, joint_compatibility, nearest_neighbour
from .calibrated_motion import OdometryNoise
from .config import EkfSlamConfig
from .filter import FIXED, LandmarkFilter
from .slip import Slip, find_slip
from .visibility import could_be_seen, seen_through

Array = NDArray[np.float64]

_PARTS = {"odometry": OdometryNoise, "sighting": SightingConfig}
_MOST_LANDMARKS = 1000  # the time of a step grows with their square: a second at so many


class EkfSlam:
    """EKF-SLAM on round landmarks.

    Diagnostics of an update: `sightings`, `matched`, `slipped` (1: the robot was found off where its odometry had it by
    more than the filter thought possible), `landmarks` and `sigma_position` [m].

    Args:
        config: Settings.
        clusterer: Clusters the points of each scan; None makes the one that `config` names.

    Attributes:
        filter: The filter; None before the first scan.
        times_seen: (k,) how often each landmark was matched.
    """

    def __init__(self, config: EkfSlamConfig | None = None, clusterer: Clusterer | None = None) -> None:
        self._config = config = config or EkfSlamConfig()
        self._clusterer = clusterer or clusterer_of_scans(
            config.clustering, config.cluster_distance, config.cluster_points
        )
        self._choose = joint_compatibility if self._config.association == "joint" else nearest_neighbour
        self.filter: LandmarkFilter | None = None
        self.times_seen = np.zeros(0, dtype=np.int64)
        self._missed = np.zeros(0, dtype=np.int64)
        self._known = 0  # so many landmarks, the first ones, hang together; later ones may be off by a slip
        self._odometry = self._used_at = np.zeros(3)
        self._poses = PoseLog()
        self._kept = KeptScans()  # integrated scans, from which the map is drawn
        self._live: GrowingMap | None = None  # only once `live_map` has been asked for

    @classmethod
    def from_options(cls, seed: int = 0, **options: Any) -> "EkfSlam":
        """Return an engine; `options` are fields of `EkfSlamConfig`, of its `odometry` and of its `sighting`.

        `seed` is taken as from the other engines; nothing is drawn.

        Raises:
            InputError: If a field is unknown, or a value out of its range.
        """
        del seed
        part_of = {field.name: part for part, kind in _PARTS.items() for field in fields(kind)}
        named = {f"{part_of[name]}.{name}" if name in part_of else name: value for name, value in options.items()}
        return cls(with_settings(EkfSlamConfig(), named))

    @property
    def config(self) -> EkfSlamConfig:
        """The resolved configuration."""
        return self._config

    @property
    def pose(self) -> Array:
        """(3,) T_map_robot."""
        return np.zeros(3) if self.filter is None else self.filter.x[:3].copy()

    @property
    def node_poses(self) -> Array:
        """(k, 3) T_map_robot of the integrated scans that are not superseded."""
        return self._poses.array()[self._kept.numbers]

    @property
    def node_scans(self) -> list[int]:
        """The scan that each of `node_poses` is, ascending."""
        return list(self._kept.numbers)

    def trajectory(self) -> Array:
        """Return (n, 3) T_map_robot for every scan, each as the filter believed it then."""
        return self._poses.array()

    def map(self) -> OccupancyMap:
        """Return the map that the integrated scans draw from their poses."""
        return self.map_at(self._config.resolution)

    def map_at(self, resolution: float) -> OccupancyMap:
        """Return the same with cells of `resolution` [m]."""
        return render_map(self.node_poses, self._kept.scans, GridConfig(resolution=resolution))

    def live_map(self) -> OccupancyMap:
        """Return the map to which each integrated scan is added at once, with cells of 5 cm; not to be written to."""
        if self._live is None:
            self._live = GrowingMap()
            self._live.follow(self.node_poses, self._kept.numbers, self._kept.scans)
        return self._live.map

    def finish(self) -> None:
        """Do nothing: the filter has no further work after the last scan."""

    def landmark_map(self) -> LandmarkMap | None:
        """Return the landmarks that were seen often enough to last, as localization takes them; None: there is none.

        The covariances are those of the places in the frame of the first pose.
        """
        lasting = np.flatnonzero(self.times_seen >= self._config.sure)
        if self.filter is None or not len(lasting):
            return None
        states = FIXED + 2 * lasting[:, None] + np.arange(2)
        covariances = self.filter.P[states[:, :, None], states[:, None, :]]
        return LandmarkMap(self.filter.landmarks[lasting], covariances, self.times_seen[lasting])

    def update(self, odometry: ArrayLike, scan: LaserScan) -> SlamUpdate:
        """Take one scan and its odometry pose T_odom_robot (3,)."""
        ekf = self.filter
        now = checked_pose(odometry, before=None if ekf is None else self._odometry)
        if ekf is None:
            ekf = self.filter = LandmarkFilter(now, self._config.odometry)
        else:
            ekf.move(between(self._odometry, now))
        self._odometry = now
        moved = between(self._used_at, now)
        far = float(np.hypot(moved[0], moved[1])) >= self._config.travel or abs(moved[2]) >= self._config.turn
        integrated = far or not len(self._poses)
        diagnostics = {"sightings": 0.0, "matched": 0.0, "slipped": 0.0}
        if integrated:
            self._used_at = now
            self._kept.append(len(self._poses), scan)
            sightings = see_landmarks(scan, self._clusterer, self._config.sighting)
            with one_thread():
                diagnostics = self.take(sightings, scan)
        self._poses.append(ekf.x[:3])
        if self._kept.due:
            self._kept.thin(self.node_poses)
        if self._live and integrated:
            self._live.follow(self.node_poses, self._kept.numbers, self._kept.scans)
        a, b, c = float(ekf.P[0, 0]), float(ekf.P[0, 1]), float(ekf.P[1, 1])
        sigma = math.sqrt(0.5 * (a + c) + math.hypot(0.5 * (a - c), b))  # of the larger eigenvalue
        diagnostics |= {"landmarks": float(len(self.times_seen)), "sigma_position": sigma}
        located = sigma <= self._config.lost_sigma
        return SlamUpdate(ekf.x[:3].copy(), integrated, diagnostics, located, ekf.P[:3, :3].copy())

    def take(self, sightings: LandmarkSightings, scan: LaserScan) -> dict[str, float]:
        """Associate the sightings, correct the filter, add and forget landmarks; return what came of it."""
        ekf = self.filter
        assert ekf is not None
        near, pairs = self._compared(sightings, scan.range_max)
        chosen = self._choose(pairs, self._config.gate)
        slip = self._slip(sightings, near, chosen)
        if slip is not None:
            ekf.displace(slip.pose, slip.variances)
            self._keep(np.arange(len(self.times_seen)) < self._known)
            near, pairs = self._compared(sightings, scan.range_max)
            chosen = self._choose(pairs, self._config.gate)
        new = (pairs.distance > self._config.new_gate).all(axis=1)
        T_map_lidar = compose(ekf.x[:3], scan.T_robot_lidar)
        gone = near[seen_through(ekf.landmarks[near], T_map_lidar, scan, self._config.sighting.border)]
        used = np.array([near[j] for _, j in chosen], dtype=np.int64)
        if chosen:
            _, H, states = ekf.expect(used)
            y = np.concatenate([pairs.y[i, j] for i, j in chosen])
            ekf.correct(y, np.asarray(block_diag(*[sightings.R[i] for i, _ in chosen])), H, states)
        self._note(used, np.setdiff1d(gone, used))
        for i in np.flatnonzero(new):
            if not ekf.overlaps(sightings.z[i], self._config.sighting.radius):
                self.learn(sightings.z[i], sightings.R[i])
        matched = int((used < self._known).sum())
        if self._known == 0 or matched >= 2 or 0 < 2 * matched >= len(sightings.z):
            self._known = len(self.times_seen)
        self._keep((self.times_seen >= self._config.sure) | (self._missed < self._config.patience))
        slipped = float(slip is not None)
        return {"sightings": float(len(sightings.z)), "matched": float(len(chosen)), "slipped": slipped}

    def learn(self, z: Array, R: Array) -> None:
        """Add the landmark seen at range and bearing `z` (2,) with noise `R` (2, 2).

        Raises:
            InputError: If there are too many.
        """
        assert self.filter is not None
        if len(self.times_seen) >= _MOST_LANDMARKS:
            raise InputError(
                f"the map would hold more than {_MOST_LANDMARKS} landmarks: this is no place of single round objects; "
                "take fewer of what is seen (`cluster_points`, `widest`), or another engine"
            )
        self.filter.add(z, R)
        self.times_seen = np.append(self.times_seen, np.ones(1, dtype=np.int64))
        self._missed = np.append(self._missed, np.zeros(1, dtype=np.int64))

    def forget(self, numbers: NDArray[np.int64]) -> None:
        """Remove the landmarks with these numbers from the map."""
        self._keep(~np.isin(np.arange(len(self.times_seen)), numbers))

    def _compared(self, sightings: LandmarkSightings, range_max: float) -> tuple[NDArray[np.int64], Innovations]:
        """Return the landmarks that could be seen, and sightings and them compared."""
        ekf = self.filter
        assert ekf is not None
        near = could_be_seen(ekf, range_max)
        expected, H, states = ekf.expect(near)
        return near, compare(sightings.z, sightings.R, expected, H @ ekf.P[np.ix_(states, states)] @ H.T)

    def _slip(self, sightings: LandmarkSightings, near: NDArray[np.int64], chosen: Pairs) -> Slip | None:
        """Return the slip under which landmarks known for long explain the sightings, if nothing else does."""
        ekf = self.filter
        assert ekf is not None
        known = near[near < self._known]
        matched = sum(int(near[j]) < self._known for _, j in chosen)
        if len(known) < 2 or len(sightings.z) < 2 or 2 * matched >= len(sightings.z):
            return None
        return find_slip(sightings.z, ekf.landmarks[known], ekf.x[:3], max(3 if chosen else 2, matched + 1))

    def _note(self, used: NDArray[np.int64], gone: NDArray[np.int64]) -> None:
        """Remember which landmarks were matched and which should have been seen."""
        self.times_seen[used] += 1
        self._missed[used] = 0
        self._missed[gone] += 1

    def _keep(self, kept: NDArray[np.bool_]) -> None:
        """Forget the landmarks where `kept` is false."""
        if kept.all():
            return
        ekf = self.filter
        assert ekf is not None
        ekf.keep(kept)
        self.times_seen, self._missed = self.times_seen[kept], self._missed[kept]
        self._known = int(kept[: self._known].sum())
