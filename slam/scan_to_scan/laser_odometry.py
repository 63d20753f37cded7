"""Odometry from scans: made of them alone where a log has none, or the wheels' own, refined from scan to scan."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..bounds import check_numbers, check_positive, checked_pose
from ..errors import unknown_name
from ..geometry import between, compose, inverse, wrap_angle
from ..scan import LaserScan
from . import MATCHERS, Matcher, make_matcher

Array = NDArray[np.float64]

_FLOOR = (0.01, 0.01)  # [m, rad] odometry that reports no motion may be so far off: a robot that was pushed a little
_AT_LEAST = (0.05, 0.05)  # [m, rad] so far off may be that a robot goes on as before, however short the time ...
_ACCELERATION = (1.0, 2.0)  # [m/s^2, rad/s^2] ... and it may brake or speed up so fast: standard deviations
_SEARCH = {"second_maxima": 0, "refinement.confidence.least_points": 30}  # of many places a few points fit at one
_HALF_LIFE_S = 0.5  # of the velocity of a robot of which nothing is seen [s]
_BELIEVED = 4.0  # standard deviations of how the robot went on that a match may be away
_AGREES = 0.5  # share of its points on the other's surfaces that makes a scan match, though a direction is open
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
    """

    pose: Array
    matched: bool


@dataclass(frozen=True, eq=False)
class _Expected:
    """Where the robot should be: `pose` (3,) T_odom_robot, `sigma` standard deviations of that, `most` it can be off.

    Both are [m, rad].
    """

    pose: Array
    sigma: tuple[float, float]
    most: tuple[float, float]


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
        self._pose = np.zeros(3)
        self._step = np.zeros(3)  # how far the robot went from one scan to the next
        self._time_s: float | None = None  # of the last scan
        self._usual_s: float | None = None  # between two scans
        self._odometry: Array | None = None
        self._key: tuple[Array, LaserScan] | None = None  # pose and scan that later ones are matched with

    def update(self, scan: LaserScan, odometry: ArrayLike | None = None) -> OdometryUpdate:
        """Take the next scan of one laser and, where there is one, the odometry pose T_odom_robot (3,) at that time.

        The first pose is that of the odometry; without any it is the origin.
        """
        before, config = self._odometry, self.config
        self._odometry = None if odometry is None else checked_pose(odometry, before=before)
        elapsed_s = self._elapsed(scan.time_s)
        if self._key is None:
            self._pose = np.zeros(3) if self._odometry is None else self._odometry.copy()
            self._key = (self._pose, scan)
            return OdometryUpdate(self._pose.copy(), True)
        last = self._pose
        moved = None if before is None or self._odometry is None else between(before, self._odometry)
        expected = self._going_on(elapsed_s) if moved is None else self._by_odometry(moved)
        found = self._matched(self._matcher, self._key, scan, expected, expected.pose)
        if found is None and moved is None:
            found = self._matched(self._search, self._key, scan, expected, last)
        believed = found is not None
        self._pose = expected.pose if found is None else found
        self._step = between(last, self._pose) * (1.0 if believed else 0.5 ** (elapsed_s / _HALF_LIFE_S))
        since_key = between(self._key[0], self._pose)
        if (not believed or _farther(since_key, config.keyframe_way, config.keyframe_turn)) and scan.is_return.any():
            self._key = (self._pose, scan)  # a blind scan would be the reference of nothing
        return OdometryUpdate(self._pose.copy(), believed)

    def _by_odometry(self, moved: Array) -> _Expected:
        """Return where the robot is if it `moved` (3,) as its odometry says."""
        way = _FLOOR[0] + self.config.sigma_way * float(np.hypot(moved[0], moved[1]))
        turn = _FLOOR[1] + self.config.sigma_turn * float(abs(moved[2]))
        return _Expected(compose(self._pose, moved), (way, turn), (self.config.most_way, self.config.most_turn))

    def _going_on(self, elapsed_s: float) -> _Expected:
        """Return where the robot is if it went on as before: as far as from scan to scan, whatever their stamps say."""
        way, turn = (least + most * elapsed_s**2 for least, most in zip(_AT_LEAST, _ACCELERATION, strict=True))
        return _Expected(compose(self._pose, self._step), (way, turn), (_BELIEVED * way, _BELIEVED * turn))

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
        self, matcher: Matcher, key: tuple[Array, LaserScan], scan: LaserScan, expected: _Expected, start: Array
    ) -> Array | None:
        """Return where the scan is, T_odom_robot (3,), by how it matches from `start` (3,); None: that is not known.

        Of several places where it matches as well, the one counts where the robot can have gone, if it is only one.
        Where scans leave a direction open, as along a corridor, a match nearby tells the rest, and a search nothing.
        """
        mount = np.asarray(scan.T_robot_lidar)
        lidar_key = compose(key[0], mount)
        found = matcher.match(key[1], scan, between(lidar_key, compose(start, mount)))
        agrees = found.converged or found.ambiguous
        if found.is_blind:  # along the open direction it comes to rest nowhere, and a search ends anywhere
            agrees = found.score >= _AGREES and matcher is not self._search
        if not agrees:
            return None
        places = found.pose[None] if found.alternatives is None else np.vstack((found.pose, found.alternatives))
        wanted = between(lidar_key, compose(expected.pose, mount))
        poses = [
            compose(compose(lidar_key, _weighed(place, found.covariance, wanted, expected.sigma)), inverse(mount))
            for place in places
        ]
        near = [pose for pose in poses if not _farther(between(expected.pose, pose), *expected.most)]
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


def _weighed(place: Array, covariance: Array, expected: Array, sigma: tuple[float, float]) -> Array:
    """Return the mean of a matched `place` (3,) and what was `expected` (3,), weighed by covariances (3, 3)."""
    P = np.diag([sigma[0] ** 2, sigma[0] ** 2, sigma[1] ** 2])
    off = place - expected
    off[2] = float(wrap_angle(off[2]))
    return expected + P @ np.linalg.solve(P + covariance, off)


def _farther(motion: Array, way: float, turn: float) -> bool:
    return bool(np.hypot(motion[0], motion[1]) > way or abs(motion[2]) > turn)
