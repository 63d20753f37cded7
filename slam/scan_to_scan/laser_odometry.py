"""Odometry from scans: made of them alone where a log has none, or the wheels' own, refined from scan to scan."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..bounds import Share, check_numbers, check_positive, checked_pose
from ..errors import unknown_name
from ..geometry import between, compose, wrap_angle
from ..scan import LaserScan
from . import MATCHERS, Match, make_matcher

Array = NDArray[np.float64]

_FLOOR = (0.01, 0.01)  # [m, rad] odometry that reports no motion may be so far off: a robot that was pushed a little


@dataclass(frozen=True, kw_only=True)
class LaserOdometryConfig:
    """Settings of `ScanToScanOdometry`.

    Attributes:
        matcher: Name of the scan matcher, one of `MATCHERS`.
        settings: Fields of its configuration that differ from its preset, e.g. `{"polish": True}`.
        keyframe_way: A scan is the reference of later ones until the robot has gone so far since [m] ...
        keyframe_turn: ... or turned so far [rad].
        most_way: A match is not believed that is so far from the odometry, or, where there is none, from the scan
            before [m] ...
        most_turn: ... or turned by so much [rad].
        slowing: Share of its velocity that a robot without odometry keeps over a scan that matches nothing.
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
    slowing: Share = 0.5
    sigma_way: float = 0.2
    sigma_turn: float = 0.2

    def __post_init__(self) -> None:
        check_numbers(self)
        if self.matcher not in MATCHERS:
            raise unknown_name("scan matcher", self.matcher, MATCHERS)
        check_positive(self, "keyframe_way", "keyframe_turn", "most_way", "most_turn", "sigma_way", "sigma_turn")


@dataclass(frozen=True, eq=False)
class OdometryUpdate:
    """What scan matching made of one scan.

    Attributes:
        pose: (3,) T_odom_robot [m, m, rad].
        matched: Whether the scan was matched; if not, the pose is a guess by the odometry or by the velocity before.
    """

    pose: Array
    matched: bool


class ScanToScanOdometry:
    """The front end of a SLAM engine: matches each scan with a recent one and tells how the robot has moved.

    A match starts from where the odometry has the robot, and both are weighed by their covariances. Without odometry
    it starts from the velocity before, and stands for itself.

    Example: `engine.update(front_end.update(scan, odometry).pose, scan)`.

    Args:
        config: Settings.

    Raises:
        InputError: If a setting of the matcher is unknown or out of its range.
    """

    def __init__(self, config: LaserOdometryConfig | None = None) -> None:
        self.config = config or LaserOdometryConfig()
        self._matcher = make_matcher(self.config.matcher, **self.config.settings)
        self._pose, self._step = np.zeros(3), np.zeros(3)
        self._odometry: Array | None = None
        self._key: tuple[Array, LaserScan] | None = None  # pose and scan that later ones are matched with

    def update(self, scan: LaserScan, odometry: ArrayLike | None = None) -> OdometryUpdate:
        """Take the next scan of one laser and, where there is one, the odometry pose T_odom_robot (3,) at that time.

        The first pose is that of the odometry; without any it is the origin.
        """
        before, reported = self._odometry, None
        self._odometry = None if odometry is None else checked_pose(odometry, before=before)
        if self._key is None:
            self._pose = np.zeros(3) if self._odometry is None else self._odometry.copy()
            self._key = (self._pose, scan)
            return OdometryUpdate(self._pose.copy(), True)
        if self._odometry is not None and before is not None:
            reported = between(before, self._odometry)
        last, config = self._pose, self.config
        guess = compose(last, self._step if reported is None else reported)
        pose = self._matched(self._key, scan, guess, reported)
        expected = last if reported is None else guess
        matched = pose is not None and not _farther(between(expected, pose), config.most_way, config.most_turn)
        self._pose = pose if pose is not None and matched else guess
        self._step = between(last, self._pose) * (1.0 if matched else config.slowing)
        moved = between(self._key[0], self._pose)
        if (not matched or _farther(moved, config.keyframe_way, config.keyframe_turn)) and scan.is_return.any():
            self._key = (self._pose, scan)  # a blind scan would be the reference of nothing
        return OdometryUpdate(self._pose.copy(), matched)

    def _matched(
        self, key: tuple[Array, LaserScan], scan: LaserScan, guess: Array, reported: Array | None
    ) -> Array | None:
        """Return where the scan matches best around `guess` (3,), T_odom_robot; None: nowhere."""
        mount = np.asarray(scan.T_robot_lidar)
        lidar_key = compose(key[0], mount)
        expected = between(lidar_key, compose(guess, mount))
        found = self._matcher.match(key[1], scan, expected)
        if not found.converged:
            return None
        place = found.pose if reported is None else self._weighed(found, expected, reported)
        return compose(compose(lidar_key, place), between(mount, np.zeros(3)))

    def _weighed(self, found: Match, expected: Array, reported: Array) -> Array:
        """Return the mean of a match and of what the odometry `expected` (3,), weighed by their covariances."""
        way = _FLOOR[0] + self.config.sigma_way * float(np.hypot(reported[0], reported[1]))
        turn = _FLOOR[1] + self.config.sigma_turn * float(abs(reported[2]))
        P = np.diag([way**2, way**2, turn**2])
        off = found.pose - expected
        off[2] = float(wrap_angle(off[2]))
        return expected + P @ np.linalg.solve(P + found.covariance, off)


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

    Like any odometry it drifts, and without the wheels' it stands still along a smooth corridor.

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
