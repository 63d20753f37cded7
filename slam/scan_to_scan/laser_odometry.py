"""Odometry from scans: made of them alone where a log has none, or the wheels' own, refined from scan to scan."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..bounds import check_numbers, check_positive, checked_pose
from ..errors import unknown_name
from ..geometry import between, compose, inverse
from ..scan import LaserScan
from . import MATCHERS, Matcher, make_matcher
from .steady_motion import SteadyMotion

Array = NDArray[np.float64]

_FLOOR = (0.01, 0.01)  # [m, rad] odometry that reports no motion may be so far off: a robot that was pushed a little
_AT_LEAST = (0.02, 0.05)  # [m, rad] so far off may be that a robot goes on as before, however short the time ...
_ACCELERATION = (1.0, 2.0)  # [m/s^2, rad/s^2] ... and it may brake or speed up so fast: standard deviations
_SEARCH = {"second_maxima": 0, "refinement.confidence.least_points": 30}  # of many places a few points fit at one
_HALF_LIFE_S = 0.5  # of the velocity of a robot of which nothing is seen [s]
_BELIEVED = 4.0  # standard deviations of how the robot went on that a match may be away
_TAILS = 5.0  # a match's error is so many times what its covariance says, where one in thirty is
_AGREES = 0.8  # share of its points on the other's surfaces that makes a scan match, though a direction is open
_MEMORY = 0.1  # weight of the newest time between two scans in the usual one
_SHORTEST_S, _UNKNOWN_S = 1e-3, 1.0  # no laser turns faster: stamps that say so tell no time, it may have been so long


@dataclass(frozen=True, kw_only=True)
class LaserOdometryConfig:
    """Settings of `ScanToScanOdometry`.

    Attributes:
        matcher: Name of the scan matcher, one of `MATCHERS`.
        settings: Fields of its configuration that differ from its preset, e.g. `{"polish": True}`.
        keyframe_way: A scan is the reference of later ones until the robot has gone so far since [m] ...
        keyframe_turn: ... or turned so far [rad].
        most_way: A match is not believed that is so far from the odometry [m] ...
        most_turn: ... or turned by so much [rad].
        search_way: Without odometry, where the matcher finds nothing, so far around the scan before is searched, and
            all headings [m].
        sigma_way: Standard deviation of the odometry's way between two scans, as a share of that way. Where the scans
            show one direction worse than this, as along a corridor, the odometry counts more there.
        sigma_turn: Likewise of its turn.
    """

    matcher: str = "plicp"
    settings: Mapping[str, Any] = field(default_factory=dict)
    keyframe_way: float = 0.3
    keyframe_turn: float = 0.2
    most_way: float = 1.0
    most_turn: float = 1.0
    search_way: float = 2.0
    sigma_way: float = 0.2
    sigma_turn: float = 0.2

    def __post_init__(self) -> None:
        check_numbers(self)
        if self.matcher not in MATCHERS:
            raise unknown_name("scan matcher", self.matcher, MATCHERS)
        check_positive(
            self, "keyframe_way", "keyframe_turn", "most_way", "most_turn", "search_way", "sigma_way", "sigma_turn"
        )


@dataclass(frozen=True, eq=False)
class OdometryUpdate:
    """What scan matching made of one scan.

    Attributes:
        pose: (3,) T_odom_robot [m, m, rad].
        matched: Whether the scan was matched; if not, the pose is a guess by the odometry or by the velocity before.
        sigma: (2,) how far off the step to it from the scan before may be, standard deviations [m, rad].
    """

    pose: Array
    matched: bool
    sigma: Array


class ScanToScanOdometry:
    """The front end of a SLAM engine: matches each scan with a recent one and tells how the robot has moved.

    A match starts from where the robot is expected: where its odometry has it or, without any, where it is if it goes
    on as before. Both are weighed by their covariances, so along a corridor, where the scans say nothing about the
    way, that is what was expected. Without odometry a robot may have turned farther than a matcher looks, and be lost
    for good: where it finds nothing, the surroundings are searched exactly (`GlobalMatcher`).

    Example: `engine.update(front_end.update(scan, odometry).pose, scan)`.

    Args:
        config: Settings.

    Raises:
        InputError: If a setting of the matcher is unknown or out of its range.
    """

    def __init__(self, config: LaserOdometryConfig | None = None) -> None:
        self.config = config or LaserOdometryConfig()
        self._matcher = make_matcher(self.config.matcher, **self.config.settings)
        self._search = make_matcher("global", **{"window.linear": self.config.search_way, **_SEARCH})
        self._motion = SteadyMotion()  # of the laser, since the keyframe
        self._time_s: float | None = None  # of the last scan
        self._usual_s: float | None = None  # between two scans
        self._odometry: Array | None = None
        self._key: tuple[Array, LaserScan] | None = None  # T_odom_laser and scan that later ones are matched with

    def update(self, scan: LaserScan, odometry: ArrayLike | None = None) -> OdometryUpdate:
        """Take the next scan of one laser and, where there is one, the odometry pose T_odom_robot (3,) at that time.

        The first pose is that of the odometry; without any it is the origin.
        """
        before, config, mount = self._odometry, self.config, np.asarray(scan.T_robot_lidar)
        self._odometry = None if odometry is None else checked_pose(odometry, before=before)
        elapsed_s = self._elapsed(scan.time_s)
        if self._key is None:
            first = np.zeros(3) if self._odometry is None else self._odometry.copy()
            self._key = (compose(first, mount), scan)
            return OdometryUpdate(first, True, np.zeros(2))
        moved = None if before is None or self._odometry is None else between(before, self._odometry)
        expected, most = self._going_on(elapsed_s) if moved is None else self._by_odometry(moved, mount)
        found = self._matched(self._matcher, scan, expected, most, expected.pose)
        if found is None and moved is None:
            found = self._matched(self._search, scan, expected, most, self._motion.pose)
        known = expected if found is None else found
        self._motion = expected.slowed(0.5 ** (elapsed_s / _HALF_LIFE_S)) if found is None else found
        laser = compose(self._key[0], self._motion.pose)
        since_key = compose(compose(mount, self._motion.pose), inverse(mount))
        is_far = found is None or _farther(since_key, config.keyframe_way, config.keyframe_turn)
        if is_far and scan.is_return.any():  # a blind scan would be the reference of nothing
            self._key, self._motion = (laser, scan), self._motion.since_here()
        return OdometryUpdate(compose(laser, inverse(mount)), found is not None, known.step_sigma)

    def _by_odometry(self, moved: Array, mount: Array) -> tuple[SteadyMotion, tuple[float, float]]:
        """Return where the laser is if the robot `moved` (3,) as its odometry says, and how far off it is at most."""
        way = _FLOOR[0] + self.config.sigma_way * float(np.hypot(moved[0], moved[1]))
        turn = _FLOOR[1] + self.config.sigma_turn * float(abs(moved[2]))
        step = compose(compose(inverse(mount), moved), mount)
        return self._motion.moved(step, (way, turn)), (self.config.most_way, self.config.most_turn)

    def _going_on(self, elapsed_s: float) -> tuple[SteadyMotion, tuple[float, float]]:
        """Return where the laser is if the robot goes on as before, and how far off it is at most.

        As far as from scan to scan, whatever their stamps say.
        """
        way, turn = (least + most * elapsed_s**2 for least, most in zip(_AT_LEAST, _ACCELERATION, strict=True))
        expected = self._motion.gone_on((way, turn))
        return expected, (_BELIEVED * expected.sigma[0], _BELIEVED * expected.sigma[1])

    def _elapsed(self, time_s: float) -> float:
        """Return how long ago the last scan may have been [s]; `time_s` is the stamp of this one [s].

        Stamps are often those of arrival, late and then in bursts: it is the usual time at least.
        """
        since = 0.0 if self._time_s is None else max(time_s - self._time_s, 0.0)
        if self._time_s is not None:
            usual = since if self._usual_s is None else self._usual_s
            self._usual_s = usual + _MEMORY * (since - usual)
        self._time_s = time_s
        longest = max(since, self._usual_s or 0.0)
        return longest if longest >= _SHORTEST_S else _UNKNOWN_S

    def _matched(
        self, matcher: Matcher, scan: LaserScan, expected: SteadyMotion, most: tuple[float, float], start: Array
    ) -> SteadyMotion | None:
        """Return the motion by how a scan matches from `start` (3,), T_key_laser; None: that is not known.

        Of several places where it matches as well, the one counts where the robot can have gone, if it is only one.
        Where scans leave a direction open, as along a corridor, a match nearby tells the rest, and a search nothing.
        """
        assert self._key is not None
        found = matcher.match(self._key[1], scan, start)
        agrees = found.converged or found.ambiguous
        if found.is_blind:  # along the open direction it comes to rest nowhere, and a search ends anywhere
            agrees = found.score >= _AGREES and matcher is not self._search
        if not agrees:
            return None
        places = found.pose[None] if found.alternatives is None else np.vstack((found.pose, found.alternatives))
        motions = [expected.matched(place, _TAILS**2 * found.covariance) for place in places]
        near = [motion for motion in motions if not _farther(between(expected.pose, motion.pose), *most)]
        return near[0] if len(near) == 1 else None


@dataclass(frozen=True, eq=False)
class LaserOdometry:
    """Poses by scan matching.

    Attributes:
        poses: (n, 3) T_odom_robot of each scan [m, m, rad].
        matched: (n,) whether the scan was matched; where not, the pose is a guess by the odometry or by the velocity
            before.
    """

    poses: Array
    matched: NDArray[np.bool_]


def laser_odometry(
    scans: Sequence[LaserScan], config: LaserOdometryConfig | None = None, odometry: Array | None = None
) -> LaserOdometry:
    """Run `ScanToScanOdometry` over a whole drive.

    Like any odometry it drifts, and without the wheels' it goes on as before along a smooth corridor.

    Args:
        scans: Scans in order, of one laser.
        config: Settings.
        odometry: (n, 3) T_odom_robot that the wheels say at each scan, to be refined; None: there is none.
    """
    front_end = ScanToScanOdometry(config)
    said = [None] * len(scans) if odometry is None else odometry
    updates = [front_end.update(scan, pose) for scan, pose in zip(scans, said, strict=True)]
    poses = np.array([update.pose for update in updates]).reshape(-1, 3)
    return LaserOdometry(poses, np.array([update.matched for update in updates], dtype=np.bool_))


def _farther(motion: Array, way: float, turn: float) -> bool:
    return bool(np.hypot(motion[0], motion[1]) > way or abs(motion[2]) > turn)
