"""How far a robot usually goes from one scan to the next, and how long that takes: what tells a gap in a log."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_ACCELERATION = np.array([1.0, 2.0])  # [m/s^2, rad/s^2] of a wheeled robot among people, a standard deviation
_SHORTEST = 1e-3  # [s] no laser turns faster; stamps that are nearer to each other on average tell no time
_MEMORY = 0.1  # weight of the newest step in the usual one
_STEPS = 3.0  # so many usual steps a robot may go in the time of one
SLIP = np.array([0.5, 0.5])  # [m, rad] and so far beyond
_FARTHEST = 5.0  # [m] and no farther, without odometry


class UsualStep:
    """Learns the usual step.

    Attributes:
        size: (2,) of the step [m, rad].
        passed: So many times its interval have passed between the last two scans; 0: stamps tell no time.
    """

    def __init__(self) -> None:
        self.size = np.zeros(2)
        self.passed = 0.0
        self._time_s: float | None = None  # of the last scan
        self._interval_s = 0.0  # between two scans; 0: stamps tell no time

    def tick(self, time_s: float) -> None:
        """Learn from the next stamp how much time passes between two scans: stamps jitter, and there are pauses."""
        usual = self._interval_s
        if self._time_s is not None:
            elapsed = max(time_s - self._time_s, 0.0)
            self.passed = elapsed / usual if usual >= _SHORTEST else 0.0
            self._interval_s += _MEMORY * (min(elapsed, _STEPS * usual) - usual) if usual > 0.0 else elapsed
        self._time_s = time_s

    def learn(self, went: Array) -> None:
        """Learn from a step between two scans (2,) [m, rad]."""
        self.size = self.size + _MEMORY * (went - self.size)

    @property
    def change(self) -> Array:
        """(2,) by how much a step may differ from the one before, as a robot brakes or speeds up [m, rad]."""
        if self._interval_s < _SHORTEST:
            return self.size
        return np.minimum(_ACCELERATION * self._interval_s**2, self.size)

    def reach(self, scans: int) -> float:
        """Return how far the robot may go in so many scans, whatever its odometry says [m]."""
        return min(SLIP[0] + _STEPS * scans * self.size[0], _FARTHEST)

    def skips(self, way: float, scans: int, since_s: float) -> bool:
        """Return whether a `way` [m] in so many scans is that across a gap: beyond `reach`, but there was time for it.

        Args:
            way: By the odometry.
            scans: So many have come meanwhile.
            since_s: When it began, by the stamps [s].
        """
        if way <= self.reach(scans):
            return False
        assert self._time_s is not None
        timed = self._interval_s >= _SHORTEST
        return not timed or way <= SLIP[0] + _STEPS * self.size[0] * (self._time_s - since_s) / self._interval_s
