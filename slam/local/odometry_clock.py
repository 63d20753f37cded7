"""How late odometry comes: the clocks of odometry and laser may be offset, and messages wait on their way.

Odometry that is late by a constant time tells where the robot was that time ago. While the robot drives on evenly this
changes nothing, and when it brakes or turns the odometry seems wrong. So the offset is what makes the differences of
successive velocities explain how matched scans differ from the odometry; it is estimated by recursive regression.
"""

from collections import deque
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..geometry import arc_part, between, composed, inverted, stands, turning
from ..scan_to_grid.extrapolator import ExtrapolatorConfig

Array = NDArray[np.float64]
Pose = tuple[float, float, float]
"""x, y [m] and heading [rad]: learning takes twenty of them a scan, and an array costs more than the sums of a pose."""

_SPREAD = 0.1  # [s] standard deviation of what clocks are offset by
_SUREST = 0.01  # [s] never is it known better: it may change
_FREEDOM = 4.0  # of the t distribution of a step's errors: wheels slip, and matches fail, now and then
_SPAN, _MOST = 0.3, 64  # [s] a velocity is of so long at least, for stamps jitter; of so many scans at most
_PROBE = 0.01  # [s] for the derivative


@dataclass(frozen=True, eq=False, slots=True)
class _Told:
    """What the odometry told with a scan.

    Attributes:
        odometry: T_odom_robot.
        motion: What led there ...
        elapsed: ... and how long that took [s]; 0: it is not known.
    """

    odometry: Pose
    motion: Pose
    elapsed: float

    def later_by(self, late_s: float) -> Pose:
        """Return T_odom_robot so much later [s], or earlier, at the velocity of that motion, as long at most."""
        if not self.elapsed or late_s == 0.0:
            return self.odometry
        way = arc_part(*self.motion, min(abs(late_s) / self.elapsed, 1.0))
        return composed(*self.odometry, *(way if late_s > 0.0 else inverted(*way)))


class OdometryClock:
    """Turns odometry that is late, or early, into what it would tell at the time of the scan.

    Args:
        config: Error model of the odometry.

    Attributes:
        late_s: How late the odometry is [s].
    """

    def __init__(self, config: ExtrapolatorConfig) -> None:
        self._config = config
        self._information = _SPREAD**-2.0
        self._last: _Told | None = None  # what was told with the last scan ...
        self._before: _Told | None = None  # ... and the one before
        self._recent = deque[tuple[float, Array]](maxlen=_MOST)  # times and odometry
        self.late_s = 0.0

    def apply(self, odometry: Array, time_s: float) -> Array:
        """Return T_odom_robot (3,) at the time of a scan that comes with the pose `odometry` (3,) at `time_s` [s]."""
        self._before = self._last
        if self._last is None or not stands(between(self._last.odometry, odometry)):  # else it tells nothing new
            self._last = self._told(odometry, time_s)
            self._recent.append((time_s, odometry))
        return np.array(self._last.later_by(self.late_s))

    def _told(self, odometry: Array, time_s: float) -> _Told:
        for at_s, pose in reversed(self._recent):
            if time_s - at_s >= _SPAN:
                return _Told(_pose(odometry), _pose(between(pose, odometry)), time_s - at_s)
        return _Told(_pose(odometry), (0.0, 0.0, 0.0), 0.0)

    def learn(self, step: Array, information: Array) -> None:
        """Learn from two scans that were matched, the last and the one before.

        Args:
            step: (3,) how the robot moved between them by the matches, in its frame at the first [m, m, rad].
            information: (3, 3) inverse covariance of that as far as the scans alone tell it, in the same frame.
        """
        if not (self._last and self._last.elapsed and self._before and self._before.elapsed):
            return
        told, less, more = (self._step(self.late_s + probe) for probe in (0.0, -_PROBE, _PROBE))
        by_second = np.array(composed(*inverted(*less), *more)) / (2.0 * _PROBE)
        told = np.array(told)
        error, turn = between(told, step), turning(step.item(2))
        linear, angular = np.square(self._config.sigma(told)).tolist()
        seen = turn.T @ information @ turn
        weights = seen @ np.linalg.inv(np.eye(3) + np.diag((linear, linear, angular)) @ seen)
        weights *= (_FREEDOM + 3.0) / (_FREEDOM + float(error @ weights @ error))
        information_now = min(self._information, _SUREST**-2.0) + float(by_second @ weights @ by_second)
        self.late_s += float(by_second @ weights @ error) / information_now
        self._information = information_now

    def _step(self, late_s: float) -> Pose:
        """Return the last step of odometry that is so late [s]."""
        assert self._last is not None
        assert self._before is not None
        return composed(*inverted(*self._before.later_by(late_s)), *self._last.later_by(late_s))


def _pose(pose: Array) -> Pose:
    x, y, heading = pose.tolist()
    return x, y, heading
