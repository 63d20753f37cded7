"""Scan-to-scan consistency: a robot that drives sees almost the same again in the next scan, a kidnapped one does not.

Local SLAM drifts little by little, and in a building that repeats itself another place may then explain the scans
better than the one where the robot is. Only an inconsistency between two scans tells that from a kidnapping.
"""

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ...bounds import check_numbers
from ...errors import InputError
from ...geometry import between, inverse
from ...scan import LaserScan
from ...scan_to_grid.extrapolator import ExtrapolatorConfig

Array = NDArray[np.float64]

_ENOUGH = 180  # returns of a scan that are compared, about
_MEMORY = 0.05  # weight of the newest scan in the usual share of contradictions


@dataclass(frozen=True, kw_only=True)
class ScanConsistencyConfig:
    """Settings of `ScanConsistency`.

    Attributes:
        slack: A return must lie so far before the end of the other scan's beams to contradict them [m].
        least: Two scans are inconsistent if so much more than the usual share of returns contradicts the other ...
        deviations: ... and so many usual deviations more.
        suspect: Such a share of that is enough for a scan that is the first to contradict what was mapped.
        sigmas: A match is believed if it differs from the odometry by no more than so many standard deviations ...
        near: ... or by no more than this [m, rad].
    """

    slack: float = 0.4
    least: float = 0.02
    deviations: float = 4.0
    suspect: float = 0.5
    sigmas: float = 4.0
    near: tuple[float, float] = (0.1, 0.1)

    def __post_init__(self) -> None:
        check_numbers(self)
        for name, value in vars(self).items():
            if not np.all(np.asarray(value) > 0.0):
                raise InputError(f"`{name}` must be positive, got {value}")


class ScanConsistency:
    """Compares each scan with the one before.

    Args:
        config: Settings.
        odometry: How the odometry errs.
    """

    def __init__(self, config: ScanConsistencyConfig, odometry: ExtrapolatorConfig) -> None:
        self._config, self._odometry = config, odometry
        self._before: tuple[LaserScan, Array, Array] | None = None
        self._usual = self._deviation = 0.0

    def inconsistency(self, scan: LaserScan, odometry: Array, pose: Array, suspect: bool = False) -> float:
        """Take a scan; return the share of returns that contradict it and the one before, 0 where they are consistent.

        They are consistent if they are by the motion between their matches, or by the odometry. A match on what only
        looks alike leads where the odometry cannot have led: that one is not believed.

        Args:
            scan: The scan.
            odometry: (3,) T_odom_robot.
            pose: (3,) T_local_robot, where it fits best on what was mapped before.
            suspect: Whether it is the first to contradict that.
        """
        before, self._before = self._before, (scan, odometry, pose)
        if before is None:
            return 0.0
        bar = self._config.least + self._config.deviations * self._deviation
        bar *= self._config.suspect if suspect else 1.0
        moved, matched = between(before[1], odometry), between(before[2], pose)
        likely, other = (matched, moved) if self._led(moved, matched) else (moved, moved)
        share = contradiction(before[0], scan, likely, self._config.slack)
        if share > self._usual + bar and other is not likely:
            share = min(share, contradiction(before[0], scan, other, self._config.slack))
        above = share - self._usual
        usual = min(above, bar)  # one inconsistent scan says little of what is usual, but many in a row do
        self._usual += _MEMORY * usual
        self._deviation += _MEMORY * (abs(usual) - self._deviation)
        return share if above > bar else 0.0

    def _led(self, moved: Array, matched: Array) -> bool:
        """Return whether the robot may have moved as it was `matched` (3,) where the odometry says `moved` (3,)."""
        off, most = between(moved, matched), self._config.sigmas * self._odometry.sigma(moved)
        most = np.maximum(most, self._config.near)
        return bool(np.hypot(off[0], off[1]) <= most[0] and abs(off[2]) <= most[1])


def contradiction(before: LaserScan, after: LaserScan, motion: Array, slack: float) -> float:
    """Return the share of two scans' returns that lie where the other scan looked through, in [0, 1].

    Args:
        before: A scan.
        after: Another one.
        motion: (3,) T_before_after of the robot [m, m, rad].
        slack: A return must lie so far before the end of a beam to contradict it [m].
    """
    count = asked = 0
    for seen, seeing, T in ((after, before, motion), (before, after, inverse(motion))):
        points = np.ascontiguousarray(seen.points_robot[:: max(1, len(seen.points) // _ENOUGH)])
        mount = np.array(seeing.T_robot_lidar, dtype=np.float64)
        count += looked_through(seeing.bearings, seeing.ranges, seeing.range_max, mount, points, T, slack)
        asked += len(points)
    return count / max(asked, 1)


@njit(cache=True, nogil=True)
def looked_through(
    bearings: Array, ranges: Array, range_max: float, mount: Array, points: Array, motion: Array, slack: float
) -> int:
    """Return how many of `points` (N, 2) lie more than `slack` [m] before the ends of both beams beside them.

    Args:
        bearings: (M,) of the beams, ascending [rad].
        ranges: (M,) of the beams [m]; beams without a return say nothing.
        range_max: Longest range of a return [m].
        mount: (3,) T_robot_lidar.
        points: Robot frame of the other scan [m].
        motion: (3,) T_robot_other.
        slack: [m].
    """
    turn = motion[2] - mount[2]
    c, s, cm, sm = np.cos(turn), np.sin(turn), np.cos(mount[2]), np.sin(mount[2])
    x0 = cm * (motion[0] - mount[0]) + sm * (motion[1] - mount[1])
    y0 = cm * (motion[1] - mount[1]) - sm * (motion[0] - mount[0])
    count, right, last = 0, 0, len(bearings) - 1
    if last < 1:
        return 0
    for n in range(len(points)):
        x = x0 + c * points[n, 0] - s * points[n, 1]
        y = y0 + s * points[n, 0] + c * points[n, 1]
        bearing = np.arctan2(y, x)
        bearing += 2.0 * np.pi * np.ceil((bearings[0] - bearing) / (2.0 * np.pi))
        if not bearings[0] <= bearing < bearings[last]:
            continue
        while bearings[right] > bearing:  # the points come in the order of the beams, almost
            right -= 1
        while bearings[right + 1] <= bearing:
            right += 1
        one, other, end = ranges[right], ranges[right + 1], np.sqrt(x * x + y * y) + slack
        count += end < one <= range_max and end < other <= range_max
    return count
