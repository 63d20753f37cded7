"""GMapping: a Rao-Blackwellized particle filter that maps with a laser (Grisetti, Stachniss, Burgard 2007)."""

from array import array
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..bounds import checked_pose
from ..engine import SlamUpdate
from ..geometry import between, compose, wrap_angle
from ..grid import GridConfig, render_map, scan_rays
from ..occupancy_map import OccupancyMap
from ..pose_log import PoseLog
from ..processes.threads import Workers
from ..revisits import KeptScans, RevisitConfig
from ..scan import LaserScan
from ..scan_to_scan.stopped_odometry import StoppedOdometry
from ..settings import with_settings
from .config import GMappingConfig
from .matcher import ParticleScanMatcher
from .motion import MotionModel, turned, turned_once
from .path_covariance import PathCovariance
from .paths import PathTree
from .resampling import effective_number, normalised, systematic
from .tile_maps import TileMaps
from .tracking import Tracker

Array = NDArray[np.float64]


class GMapping:
    """Particles, each with a path and a map of its own; a `SlamEngine`.

    A scan that follows enough motion is matched: odometry predicts, each particle is aligned with its own map, its
    pose is drawn from the Gaussian around the best alignment, weighed by how well the scan fits and, when few
    particles carry the weight, resampled; then the scan is written into each map. Every scan is followed on the best
    particle's map, and where the odometry does not explain it, looked for around (`tracking.py`). Scans stand for
    odometry that has stopped (`StoppedOdometry`).

    `SlamUpdate.located` is False where a scan contradicts the map wherever the robot may be, where it was found without
    the odometry and still fits badly, and where the particles disagree.

    `SlamUpdate.covariance` is that of the pose, seen from where the drive began: by the matches that lead there
    (`path_covariance.py`), and by how far the particles disagree.

    `SlamUpdate.diagnostics`: `neff` (effective number of particles, of a matched scan before resampling), `loss` (mean
    misfit of the scan, 0 .. 1), `resampled` (0 or 1); `odometry_fault` (1: the robot moved otherwise than its odometry
    says).

    Args:
        config: Parameters.
        seed: Seed of every random draw; two runs with one seed are equal to the byte, for any number of threads.
    """

    def __init__(self, config: GMappingConfig | None = None, seed: int | np.random.SeedSequence = 0) -> None:
        self.config = config or GMappingConfig()
        self._rng = np.random.default_rng(seed)
        workers = Workers(self.config.threads)
        config = self.config
        self._maps = TileMaps(config.particles, config.delta, config.fullness, workers, config.ray_margin)
        self._matcher = ParticleScanMatcher(self.config.matcher, workers)
        self._motion = MotionModel(
            config.srr, config.srt, config.str_, config.stt, config.tracking.memory,
            config.linear_update, config.angular_update,
        )  # fmt: skip
        self._tracker = Tracker(config.tracking, self._matcher, self._motion, config.minimum_score)
        self._paths = PathTree()
        self._poses = np.zeros((self.config.particles, 3))
        self._log_weights = np.zeros(self.config.particles)  # since the last resampling
        self._log_evidence = np.zeros(self.config.particles)  # of the whole path
        self._told: Array | None = None  # odometry as it comes
        self._odometry: Array | None = None
        self._stopped = StoppedOdometry()
        self._ranges = b""  # of the last scan
        self._spread = np.zeros((3, 3))  # covariance of the particles' poses
        self._online = PoseLog()
        self._matched = array("q")  # the scans that were; the others follow the last one before
        self._offsets = PoseLog()  # T_matched_scan
        self._kept = KeptScans()  # matched scans, from which maps are drawn

    @classmethod
    def from_options(cls, seed: int = 0, **options: Any) -> Self:
        """Return an engine with fields of `GMappingConfig` as keywords.

        Raises:
            InputError: If a field is unknown, or a value out of its range.
        """
        return cls(with_settings(GMappingConfig(), options), seed)

    def update(self, odometry: ArrayLike, scan: LaserScan) -> SlamUpdate:
        """Take one scan and the robot's odometry pose T_odom_robot (3,) at that time."""
        self._told = checked_pose(odometry, before=self._told)
        odometry = self._stopped.apply(self._told, scan)
        diagnostics: dict[str, float] = {}
        if self._odometry is None:
            self._poses[:] = odometry
            self._uncertainty = PathCovariance(odometry, RevisitConfig().distance)
            integrated = True
        else:
            points_robot = self._points(scan)
            believed = self._track(points_robot, between(self._odometry, odometry), scan.time_s)
            diagnostics["odometry_fault"] = float(self._stopped.has_stopped or not believed)
            integrated = self._is_due() and len(points_robot) > 0
            if integrated:
                diagnostics |= self._process(points_robot, float(np.ptp(scan.bearings)))
        if integrated:
            self._integrate(scan)
            self._matched.append(len(self._offsets))
        self._odometry = odometry
        self._offsets.append(self._tracker.pose)
        pose, spread = self.pose, self._disagreement()
        self._online.append(pose)
        near = spread[0, 0] + spread[1, 1] <= self.config.tracking.spread**2
        covariance = spread + self._uncertainty.at(pose)
        return SlamUpdate(pose, integrated, diagnostics, bool(near and self._tracker.located), covariance)

    def finish(self) -> None:
        """Do nothing: the filter has no further work after the last scan."""

    @property
    def pose(self) -> Array:
        """(3,) T_map_robot of the best particle now."""
        return compose(self._poses[self.best_particle], self._tracker.pose)

    @property
    def best_particle(self) -> int:
        """The particle whose whole path explains the scans best."""
        return int(self._log_evidence.argmax())

    def trajectory(self) -> Array:
        """Return (n, 3) T_map_robot for every scan so far, along the best particle's path."""
        if not self._matched:
            return np.zeros((0, 3))
        path, followers = self._paths.path(self.best_particle), np.diff(self._matched, append=len(self._offsets))
        return compose(np.repeat(path, followers, axis=0), self._offsets.array())

    def online_trajectory(self) -> Array:
        """Return (n, 3) T_map_robot as `update` returned them, each the best knowledge of its time."""
        return self._online.array()

    def map(self) -> OccupancyMap:
        """Return the map that the matched scans draw along the best particle's path, with cells of `delta`."""
        return self.map_at(self.config.delta)

    def map_at(self, resolution: float) -> OccupancyMap:
        """Return the map with cells of `resolution` [m], drawn anew from the matched scans that are not superseded."""
        path = self._paths.path(self.best_particle)[self._kept.numbers]
        return render_map(path, self._kept.scans, GridConfig(resolution=resolution, max_range=self.config.max_urange))

    def live_map(self) -> OccupancyMap:
        """Return the best particle's own map, with cells of `delta`: ready at any time, in a few milliseconds.

        `probability` is the share of hits among a cell's visits; the map of `map_at` is crisper.
        """
        return self._maps.to_map(self.best_particle)

    def _points(self, scan: LaserScan) -> Array:
        """Return (n, 2) returns in the robot frame [m]; none of a scan that a driver gave a second time."""
        last, self._ranges = self._ranges, scan.ranges.tobytes()
        if self._ranges == last:
            return np.zeros((0, 2))
        if scan.range_max <= self.config.max_urange:
            return scan.points_robot
        return scan.points_robot[scan.ranges[scan.beams] <= self.config.max_urange]

    def _is_due(self) -> bool:
        x, y, heading = self._tracker.pose.tolist()
        way, turn = max(self._motion.travelled, np.hypot(x, y)), max(self._motion.turned, abs(heading))
        return bool(way >= self.config.linear_update or turn >= self.config.angular_update)

    def _track(self, points_robot: Array, increment: Array, time_s: float) -> bool:
        """Follow the robot on the best particle's map, gather how it moved, and return whether as the odometry says."""
        particle = self.best_particle
        tracked = self._tracker.track(self._maps, particle, self._poses[particle], points_robot, increment, time_s)
        self._motion.add(increment if tracked.believed else tracked.motion)
        return tracked.believed

    def _disagreement(self) -> Array:
        """Return the covariance (3, 3) of the particles' poses and of the motion since, map frame."""
        return self._spread + turned_once(self._tracker.covariance, self._poses.item(self.best_particle, 2))

    def _process(self, points_robot: Array, field_of_view: float) -> dict[str, float]:
        """Match, draw, weigh and resample."""
        means = compose(self._poses, self._tracker.pose)
        prior = self._motion.covariance_at(self._tracker.pose)
        covariances = turned(prior, self._poses[:, 2])
        matches = self._matcher.match(self._maps, points_robot, means, covariances, self._rng)
        lost = matches.losses > 1.0 - self.config.minimum_score
        modes, roots = matches.modes, matches.roots
        if lost.any():
            modes = np.where(lost[:, None], compose(self._poses, self._motion.mean), modes)
            roots = np.where(lost[:, None, None], np.linalg.cholesky(covariances), roots)
        best = self.best_particle
        posterior = turned_once(roots[best] @ roots[best].T, -self._poses.item(best, 2))
        self._motion.learn(between(self._poses[best], modes[best]), prior, posterior)
        self._poses = modes + np.einsum("pij,pj->pi", roots, self._rng.standard_normal(means.shape))
        self._poses[:, 2] = wrap_angle(self._poses[:, 2])
        gains = -min(self.config.observation_gain, matches.points) * matches.losses
        self._log_weights += gains
        self._log_evidence += gains
        self._paths.append(self._poses)
        best = self.best_particle
        self._uncertainty.append(self._poses[best], roots[best] @ roots[best].T, field_of_view, not lost[best])
        weights = normalised(self._log_weights)
        self._spread = _covariance(self._poses, weights)
        neff, offset = effective_number(weights), self._rng.random()
        resampled = neff < self.config.resample_threshold * self.config.particles
        if resampled:
            self._resample(systematic(weights, offset))
        self._motion.reset()
        self._tracker.anchor()
        return {"neff": neff, "loss": float(matches.losses.mean()), "resampled": float(resampled)}

    def _resample(self, parents: NDArray[np.intp]) -> None:
        self._maps.resample(parents)
        self._paths.resample(parents)
        self._poses = self._poses[parents]
        self._log_evidence = self._log_evidence[parents]
        self._log_weights = np.zeros(self.config.particles)

    def _integrate(self, scan: LaserScan) -> None:
        """Write the scan into every map."""
        if not len(self._paths):
            self._paths.append(self._poses)
        self._kept.append(len(self._paths) - 1, scan)
        if self._kept.due:
            self._kept.thin(self._paths.path(self.best_particle)[self._kept.numbers])
        points_lidar, is_hit = scan_rays(scan, self.config.max_urange)
        if len(points_lidar):
            self._maps.write(compose(self._poses, scan.T_robot_lidar), points_lidar, is_hit)


def _covariance(poses: Array, weights: Array) -> Array:
    """Return the covariance (3, 3) of poses (P, 3), whose headings are not far apart, by weights (P,)."""
    off = poses - poses[0]
    off[:, 2] = wrap_angle(off[:, 2])
    off -= weights @ off
    return (off.T * weights) @ off
