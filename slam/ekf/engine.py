"""EKF-SLAM as an engine: cluster, associate, update, manage landmarks."""

from dataclasses import fields
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import block_diag

from ..engine import SlamUpdate
from ..errors import InputError
from ..geometry import between, compose, wrap_angle
from ..grid import GridConfig, render_map
from ..landmarks.clustering import make_clusterer
from ..landmarks.objects import SightingConfig, Sightings, see_landmarks
from ..occupancy_map import OccupancyMap
from ..scan import LaserScan
from .association import Comparison, Pairs, compare, joint_compatibility, nearest_neighbour
from .calibrated_motion import OdometryNoise
from .config import EkfSlamConfig
from .filter import LandmarkFilter

Array = NDArray[np.float64]

_REACH = 1.5  # landmarks so much beyond the range are compared, too, besides three sigmas [m]


class EkfSlam:
    """EKF-SLAM on round landmarks.

    Diagnostics of an update: `sightings`, `matched`, `landmarks` and `sigma_position` [m].

    Args:
        config: Settings.

    Attributes:
        filter: The filter; None before the first scan.
        times_seen: (k,) how often each landmark was matched.
    """

    def __init__(self, config: EkfSlamConfig | None = None) -> None:
        self._config = config or EkfSlamConfig()
        settings: dict[str, float | int] = {}
        if self._config.clustering == "dbscan":
            settings = {"epsilon": self._config.cluster_distance, "min_points": self._config.cluster_points}
        if self._config.clustering == "heuristic":
            settings = {"distance": self._config.cluster_distance, "min_points": self._config.cluster_points}
        self._clusterer = make_clusterer(self._config.clustering, **settings)
        self.filter: LandmarkFilter | None = None
        self.times_seen = np.zeros(0, dtype=np.int64)
        self._missed = np.zeros(0, dtype=np.int64)
        self._odometry = self._used_at = np.zeros(3)
        self._poses: list[Array] = []
        self._used: list[tuple[int, LaserScan]] = []

    @classmethod
    def from_options(cls, seed: int = 0, **options: Any) -> "EkfSlam":
        """Return an engine; `options` are fields of `EkfSlamConfig`, of its `odometry` and of its `sighting`.

        `seed` is taken as from the other engines; nothing is drawn.
        """
        del seed
        parts: dict[str, Any] = {}
        for name, kind in (("odometry", OdometryNoise), ("sighting", SightingConfig)):
            own = {field.name: options.pop(field.name) for field in fields(kind) if field.name in options}
            if own:
                parts[name] = kind(**own)
        return cls(EkfSlamConfig(**parts, **options))

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
        """(k, 3) T_map_robot of the integrated scans."""
        return np.array([self._poses[number] for number, _ in self._used]).reshape(-1, 3)

    def trajectory(self) -> Array:
        """Return (n, 3) T_map_robot for every scan, each as the filter believed it then."""
        return np.array(self._poses).reshape(-1, 3)

    def map(self) -> OccupancyMap:
        """Return the map that the integrated scans draw from their poses."""
        return self.map_at(self._config.resolution)

    def map_at(self, resolution: float) -> OccupancyMap:
        """Return the same with cells of `resolution` [m]."""
        return render_map(self.node_poses, [scan for _, scan in self._used], GridConfig(resolution=resolution))

    def update(self, odometry: ArrayLike, scan: LaserScan) -> SlamUpdate:
        """Take one scan and its odometry pose T_odom_robot (3,)."""
        now = np.array(odometry, dtype=np.float64)
        if now.shape != (3,) or not np.isfinite(now).all():
            raise InputError(f"`odometry` must be three finite numbers, got {now}")
        ekf = self.filter
        if ekf is None:
            ekf = self.filter = LandmarkFilter(now, self._config.odometry)
        else:
            ekf.move(between(self._odometry, now))
        self._odometry = now
        moved = between(self._used_at, now)
        far = float(np.hypot(moved[0], moved[1])) >= self._config.travel or abs(moved[2]) >= self._config.turn
        integrated = far or not self._used
        diagnostics = {"sightings": 0.0, "matched": 0.0}
        if integrated:
            self._used_at = now
            self._used.append((len(self._poses), scan))
            sightings = see_landmarks(scan, self._clusterer, self._config.sighting)
            diagnostics = self.take(sightings, compose(ekf.x[:3], scan.T_robot_lidar), scan)
        self._poses.append(ekf.x[:3].copy())
        sigma = float(np.sqrt(np.linalg.eigvalsh(ekf.P[:2, :2])[-1]))
        diagnostics |= {"landmarks": float(len(self.times_seen)), "sigma_position": sigma}
        return SlamUpdate(ekf.x[:3].copy(), integrated, diagnostics, sigma <= self._config.lost_sigma)

    def take(self, sightings: Sightings, T_map_lidar: Array, scan: LaserScan) -> dict[str, float]:
        """Associate the sightings, correct the filter, add and forget landmarks; return what came of it."""
        ekf = self.filter
        assert ekf is not None
        near = self._near(scan.range_max)
        expected, H, states = ekf.expect(near)
        pairs = compare(sightings.z, sightings.R, expected, H @ ekf.P[np.ix_(states, states)] @ H.T)
        chosen = self._associate(pairs)
        new = (pairs.distance > self._config.new_gate).all(axis=1)
        gone = self._should_be_seen(near, T_map_lidar, scan)
        if chosen:
            used = np.array([near[j] for _, j in chosen])
            _, H, states = ekf.expect(used)
            y = np.concatenate([pairs.y[i, j] for i, j in chosen])
            ekf.correct(y, np.asarray(block_diag(*[sightings.R[i] for i, _ in chosen])), H, states)
            self.times_seen[used] += 1
            self._missed[used] = 0
            gone = np.setdiff1d(gone, used)
        self._missed[gone] += 1
        for i in np.flatnonzero(new):
            ekf.add(sightings.z[i], sightings.R[i])
        self.times_seen = np.append(self.times_seen, np.ones(int(new.sum()), dtype=np.int64))
        self._missed = np.append(self._missed, np.zeros(int(new.sum()), dtype=np.int64))
        self._forget()
        return {"sightings": float(len(sightings.z)), "matched": float(len(chosen))}

    def _associate(self, pairs: Comparison) -> Pairs:
        choose = joint_compatibility if self._config.association == "joint" else nearest_neighbour
        return choose(pairs, self._config.gate)

    def _near(self, range_max: float) -> NDArray[np.int64]:
        """Return the numbers of the landmarks that could be seen."""
        ekf = self.filter
        assert ekf is not None
        apart = ekf.landmarks - ekf.x[:2]
        sigma = float(np.sqrt(np.trace(ekf.P[:2, :2])))
        return np.flatnonzero(np.hypot(apart[:, 0], apart[:, 1]) <= range_max + _REACH + 3.0 * sigma)

    def _should_be_seen(self, near: NDArray[np.int64], T_map_lidar: Array, scan: LaserScan) -> NDArray[np.int64]:
        """Return those of `near` whose beam goes on behind them: they are not where they are believed."""
        ekf = self.filter
        assert ekf is not None
        apart = ekf.landmarks[near] - T_map_lidar[:2]
        r = np.hypot(apart[:, 0], apart[:, 1])
        bearing = wrap_angle(np.arctan2(apart[:, 1], apart[:, 0]) - T_map_lidar[2])
        inside = (bearing > scan.bearings[0]) & (bearing < scan.bearings[-1])
        beam = np.clip(np.searchsorted(scan.bearings, bearing), 0, len(scan) - 1)
        passed = np.where(np.isnan(scan.ranges[beam]), 0.0, scan.ranges[beam]) > r + 1.0
        return near[inside & passed & (r < scan.range_max - 2.0 * self._config.sighting.border)]

    def _forget(self) -> None:
        """Forget landmarks that were never sure and are not there."""
        kept = (self.times_seen >= self._config.sure) | (self._missed < self._config.patience)
        if kept.all():
            return
        ekf = self.filter
        assert ekf is not None
        ekf.keep(kept)
        self.times_seen, self._missed = self.times_seen[kept], self._missed[kept]
