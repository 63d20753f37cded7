"""Follows the robot from scan to scan on one particle's map, and asks whether the odometry tells the truth."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..geometry import between, compose, wrap_one
from .alignment import Candidate, MapAlignment
from .config import TrackingConfig
from .matcher import ParticleScanMatcher
from .motion import FLOOR, MotionModel, carried, turned_once
from .tile_maps import TileMaps

Array = NDArray[np.float64]

_MOST_NOISE = 3.0  # times the standard deviation; an odometry that is farther off than that lies
_MOST_POOR = 3  # scans in a row that nothing explains: beyond that, they say nothing new
_MOST_REACH = np.array([5.0, np.pi])  # [m, rad] farther off, other places look alike


@dataclass(frozen=True, eq=False)
class Tracked:
    """Where a scan has the robot.

    Attributes:
        motion: (3,) T_before_now.
        believed: Whether the odometry explains the scan; if not, `motion` was found without it.
    """

    motion: Array
    believed: bool


class Tracker:
    """Aligns each scan with a map from where the odometry has the robot; where that fails, looks all around.

    That the odometry lies about an increment is a hypothesis with a small probability; the robot may then be anywhere
    within reach of where it was. The two are weighed by the evidence of the scan for each: a robot that may be anywhere
    will find a place that a few beams fit, by chance. Where nothing explains the scan, as in a crowd, it says nothing
    about the odometry. The search costs as much as many matches, and is made only where it could win.

    Args:
        config: Parameters.
        matcher: Aligns scans.
        model: Says how far off the odometry may be while it tells the truth.
        minimum_score: 1 - loss that a match must reach; else the odometry is all there is.
    """

    def __init__(
        self, config: TrackingConfig, matcher: ParticleScanMatcher, model: MotionModel, minimum_score: float
    ) -> None:
        self.config = config
        self._matcher = matcher
        self._model = model
        self._most_loss = 1.0 - minimum_score
        self._least = np.array([config.least_way, config.least_turn])  # [m, rad]
        self._reach = self._least.copy()  # [m, rad] the largest motions of late
        self._time_s, self._usual_s = np.inf, np.inf  # of the last scan; between two scans
        self.located = True  # whether the last scan leaves no doubt where the robot is
        self._motion = np.zeros(3)  # between the last two scans
        self._noise = 1.0  # how many times its variance the odometry's squared error is of late, at least 1
        self._poor = 0  # scans in a row that nothing explained: the robot may be so many times as far
        self._samples = np.random.default_rng(0).standard_normal((matcher.config.samples, 3))  # the same for each scan
        self.anchor()

    def anchor(self) -> None:
        """Start again from where a particle's map was extended: there the robot stands, by definition."""
        self.pose = np.zeros(3)  # T_matched_robot
        self.covariance = np.zeros((3, 3))

    def track(
        self, maps: TileMaps, particle: int, origin: Array, points_robot: Array, increment: Array, time_s: float
    ) -> Tracked:
        """Take the next scan.

        Args:
            maps: The maps.
            particle: Whose map it is.
            origin: (3,) T_map_matched, that particle's pose at its last matched scan.
            points_robot: (n, 2) returns in the robot frame [m]; where there are none, the odometry is all there is.
            increment: (3,) T_before_now by odometry.
            time_s: When the scan was taken.
        """
        longer, deviations, last = self._longer(time_s), self._model.deviations(increment), self.pose
        covariance = self._predicted(increment, deviations)
        found, believed = None, True
        if len(points_robot):
            found, believed = self._found(
                MapAlignment(maps, particle, points_robot, self._matcher, self.config),
                compose(origin, last),
                compose(origin, compose(last, increment)),
                turned_once(covariance, origin.item(2)),
                self._reach * max(longer, 1.0 + self._poor),
            )
        if found is None or found.loss > self._most_loss:
            self.pose, self.covariance = compose(last, increment), covariance
            return Tracked(increment, True)
        self.pose, self.covariance = between(origin, found.pose), turned_once(found.covariance, -origin.item(2))
        motion = between(last, self.pose)
        self._learn(motion, increment, deviations, longer)
        explained = believed or -found.value <= self.config.misfit
        self.located = found.against <= self.config.lost and explained
        self._poor = min(self._poor + 1, _MOST_POOR) if -found.value > self.config.lie else 0
        return Tracked(motion, believed)

    def _found(
        self, aligned: MapAlignment, last: Array, said: Array, covariance: Array, reach: Array
    ) -> tuple[Candidate, bool]:
        """Return the best candidate, and whether it is the odometry's.

        Args:
            aligned: The scan on the map.
            last: (3,) T_map_robot of the scan before.
            said: (3,) T_map_robot now by odometry, and its `covariance` (3, 3).
            reach: (2,) how far the robot may have gone [m] and turned [rad]: two standard deviations.
        """
        config, best = self.config, aligned.refined(said, said, covariance, near=True)
        if -best.value > self._matcher.config.suspicion:
            best = max(best, aligned.sampled(said, covariance, self._samples), key=lambda candidate: candidate.value)
        far = _sizes(between(last, said)) / (0.5 * reach)
        unlikely = min(0.5 * float(far @ far), config.lie)
        if unlikely - best.value <= config.lie:
            return best, True
        reach, enough = np.minimum(reach, _MOST_REACH), best.evidence - unlikely + config.lie
        # unless the robot cannot have moved so, what explains the scan badly is no evidence
        good = -config.lie if unlikely < config.lie else -np.inf
        others = aligned.around(last, reach, enough, good)
        others.append(aligned.steady(last, compose(last, self._motion), reach))
        other = max((other for other in others if other.value > good), key=_evidence, default=best)
        believed = other.evidence <= enough
        return best if believed else other, believed

    def _learn(self, motion: Array, increment: Array, deviations: Array, longer: float) -> None:
        """Remember how far the robot goes between two scans, and how far off the odometry is."""
        config, self._motion = self.config, motion
        off = between(increment, motion) / (deviations + FLOOR)
        square = min(float(off @ off) / 3.0, _MOST_NOISE**2)
        self._noise += (max(square, 1.0) - self._noise) / config.memory
        self._reach += (self._least - self._reach) / config.memory
        self._reach = np.maximum(self._reach, self._least + config.agility * _sizes(motion) / longer)

    def _longer(self, time_s: float) -> float:
        """Return how many times as long as usual it is since the scan before; 1 where it is not, or clocks stand."""
        passed, self._time_s = time_s - self._time_s, time_s
        if not 0.0 < passed < np.inf:
            return 1.0
        longer = max(1.0, passed / self._usual_s)
        self._usual_s = min(passed, self._usual_s) if np.isinf(self._usual_s) else self._usual_s
        self._usual_s += (min(passed, 2.0 * self._usual_s) - self._usual_s) / self.config.memory
        return longer

    def _predicted(self, increment: Array, deviations: Array) -> Array:
        """Return the covariance (3, 3) of the pose after an increment, in the frame of the matched scan."""
        carry, turn = carried(self.pose.item(2), increment)
        own = turn * (self._noise * (deviations**2 + FLOOR**2))
        return carry @ self.covariance @ carry.T + own @ turn.T


def _sizes(motion: Array) -> Array:
    """Return way [m] and turn [rad] of a motion (3,)."""
    x, y, heading = motion.tolist()
    return np.array((np.hypot(x, y), abs(wrap_one(heading))))


def _evidence(candidate: Candidate) -> float:
    return candidate.evidence
