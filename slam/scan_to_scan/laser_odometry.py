"""Odometry made from the scans alone, for logs that have none."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..geometry import between, compose
from ..scan import LaserScan
from . import make_matcher

Array = NDArray[np.float64]

_KEYFRAME = (0.3, 0.2)  # [m, rad] a scan is the reference of others until they moved so far from it
_MOST_PER_SCAN = (1.0, 1.0)  # [m, rad] a match that says the robot moved more in one scan is not believed
_SLOWING = 0.5  # share of its velocity that a robot keeps over a scan that matches nothing


@dataclass(frozen=True, eq=False)
class LaserOdometry:
    """Poses by scan matching.

    Attributes:
        poses: (n, 3) T_odom_robot of each scan [m, m, rad]; the first is the origin.
        matched: (n,) whether the scan was matched; where not, the pose is a guess by the velocity before.
    """

    poses: Array
    matched: NDArray[np.bool_]


def laser_odometry(scans: list[LaserScan], matcher: str = "plicp") -> LaserOdometry:
    """Match each scan with a recent one, starting at constant velocity.

    Like any odometry it drifts, and along a smooth corridor it stands still.

    Args:
        scans: Scans in order, of one laser.
        matcher: A name of `slam.matching.MATCHERS`.
    """
    tool = make_matcher(matcher)
    poses, matched = np.zeros((len(scans), 3)), np.ones(len(scans), dtype=np.bool_)
    key, step = 0, np.zeros(3)
    for k in range(1, len(scans)):
        mount = np.asarray(scans[k].T_robot_lidar)
        guess = compose(poses[k - 1], step)
        lidar_key = compose(poses[key], mount)
        found = tool.match(scans[key], scans[k], between(lidar_key, compose(guess, mount)))
        pose = compose(compose(lidar_key, found.pose), between(mount, np.zeros(3)))
        matched[k] = found.converged and not _farther(between(poses[k - 1], pose), _MOST_PER_SCAN)
        poses[k] = pose if matched[k] else guess
        step = between(poses[k - 1], poses[k]) * (1.0 if matched[k] else _SLOWING)
        lost = not matched[k] or _farther(between(poses[key], poses[k]), _KEYFRAME)
        if lost and scans[k].is_return.any():  # a blind scan would be the reference of nothing
            key = k
    return LaserOdometry(poses, matched)


def _farther(motion: Array, limit: tuple[float, float]) -> bool:
    return bool(np.hypot(motion[0], motion[1]) > limit[0] or abs(motion[2]) > limit[1])
