"""Follows the robot from scan to scan on one particle's map, and asks whether the odometry tells the truth."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..geometry import between, compose, wrap_angle
from .alignment import Candidate, MapAlignment
from .config import TrackingConfig
from .matcher import ParticleScanMatcher
from .motion import FLOOR, MotionModel, carried, turned
from .tile_maps import TileMaps

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Tracked:
    """Where a scan has the robot.

    Attributes:
        motion: (3,) T_before_now.
        believed: Whether the odometry explains the scan; if not, `motion` was found without it.
        against: Share of the points that contradict the map there.
        unknown: Share of the points where the map knows nothing.
    """

    motion: Array
    believed: bool
    against: float
    unknown: float


class Tracker:
    """Aligns each scan with a map from where the odometry has the robot; where that fails, looks all around.

    That the odometry lies about an increment is a hypothesis with a small probability; the robot may then be anywhere
    within reach of where it was. So is that the scan itself is strange, as in a crowd, and says nothing about either.
    The three are weighed by how well they explain the scan. The search without odometry costs as much as many matches,
    and is made only where it could win.

    Args:
        config: Parameters.
        matcher: Aligns scans.
        model: Says how far off the odometry may be while it tells the truth.
    """

    def __init__(self, config: TrackingConfig, matcher: ParticleScanMatcher, model: MotionModel) -> None:
        self.config = config
        self._matcher = matcher
        self._model = model
        self._reach = np.array([config.least_way, config.least_turn])  # [m, rad] the largest motions of late
        self._samples = np.random.default_rng(0).standard_normal((matcher.config.samples, 3))  # the same for each scan
        self.anchor()

    def anchor(self) -> None:
        """Start again from where a particle's map was extended: there the robot stands, by definition."""
        self.pose = np.zeros(3)  # T_matched_robot
        self._covariance = np.zeros((3, 3))

    def track(self, maps: TileMaps, particle: int, origin: Array, points_robot: Array, increment: Array) -> Tracked:
        """Take the next scan.

        Args:
            maps: The maps.
            particle: Whose map it is.
            origin: (3,) T_map_matched, that particle's pose at its last matched scan.
            points_robot: (n, 2) returns in the robot frame [m]; where there are none, the odometry is all that is known.
            increment: (3,) T_before_now by odometry.
        """
        covariance, last = self._predicted(increment), self.pose
        if not len(points_robot):
            self.pose, self._covariance = compose(last, increment), covariance
            return Tracked(increment, True, 0.0, 1.0)
        aligned = MapAlignment(maps, particle, points_robot, self._matcher, self.config)
        found, believed = self._found(
            aligned, compose(origin, last), compose(origin, compose(last, increment)), turned(covariance, origin[2])
        )
        self.pose, self._covariance = between(origin, found.pose), turned(found.covariance, -origin[2])
        motion = between(last, self.pose)
        self._learn(motion)
        return Tracked(motion, believed, found.against, found.unknown)

    def _found(self, aligned: MapAlignment, last: Array, said: Array, covariance: Array) -> tuple[Candidate, bool]:
        """Return the best candidate, and whether it is the odometry's; `covariance` (3, 3) is that of `said` (3,)."""
        config, best = self.config, aligned.refined(said, said, covariance)
        if -best.value > config.suspicion:
            best = max(best, aligned.sampled(said, covariance, self._samples), key=lambda candidate: candidate.value)
        if -best.value <= config.lie:
            return best, True
        enough = max(best.value + config.lie, -config.strange)
        other = aligned.around(last, self._reach, enough)
        believed = other is None or other.value <= enough
        return best if believed or other is None else other, believed

    def _learn(self, motion: Array) -> None:
        """Remember how far the robot goes between two scans."""
        config = self.config
        moved = config.agility * np.array([np.hypot(motion[0], motion[1]), abs(motion[2])])
        least = np.array([config.least_way, config.least_turn])
        self._reach = np.maximum(self._reach + (least - self._reach) / config.memory, least + moved)

    def _predicted(self, increment: Array) -> Array:
        """Return the covariance (3, 3) of the pose after an increment, in the frame of the matched scan."""
        carry, turn = carried(self.pose[2], increment)
        deviations = self._model.deviations(increment)
        return carry @ self._covariance @ carry.T + turn @ np.diag(deviations**2 + FLOOR**2) @ turn.T
