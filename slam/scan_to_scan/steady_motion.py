"""Where a laser stands since a keyframe and how far it goes from scan to scan, filtered from what matches show.

An extended Kalman filter of pose and step together: a step is like the one before but for how a robot brakes and speeds
up. So of a direction that scans hardly show, as along a corridor, many matches tell the speed and no single one does.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ..geometry import compose, wrap_angle

Array = NDArray[np.float64]

_FIRST = 0.5  # [m, rad] nothing is known of the first step: it may be so far, a standard deviation


@dataclass(frozen=True, eq=False)
class SteadyMotion:
    """What is known of the motion at one scan.

    Attributes:
        pose: (3,) T_key_laser [m, m, rad].
        step: (3,) from the scan before, in its frame.
        P: (6, 6) covariance of both.
    """

    pose: Array = field(default_factory=lambda: np.zeros(3))
    step: Array = field(default_factory=lambda: np.zeros(3))
    P: Array = field(default_factory=lambda: np.diag(np.square([0.0, 0.0, 0.0, _FIRST, _FIRST, _FIRST])))

    @property
    def sigma(self) -> tuple[float, float]:
        """Standard deviations of the pose: along its least known direction, and of its turn [m, rad]."""
        way, turn = _sigma(self.P[:3, :3])
        return float(way), float(turn)

    @property
    def step_sigma(self) -> Array:
        """(2,) standard deviations of the step, likewise [m, rad]."""
        return _sigma(self.P[3:, 3:])

    def gone_on(self, sigma: tuple[float, float]) -> "SteadyMotion":
        """Return the motion one scan later, if it goes on as before but for `sigma` [m, rad]."""
        P = self.P.copy()
        P[3:, 3:] += np.diag(np.square([sigma[0], sigma[0], sigma[1]]))
        return SteadyMotion(self.pose, self.step, P)._stepped()

    def moved(self, step: Array, sigma: tuple[float, float]) -> "SteadyMotion":
        """Return the motion one scan later, if that `step` (3,) is known but for `sigma` [m, rad]."""
        P = np.zeros((6, 6))
        P[:3, :3] = self.P[:3, :3]
        P[3:, 3:] = np.diag(np.square([sigma[0], sigma[0], sigma[1]]))
        return SteadyMotion(self.pose, step, P)._stepped()

    def _stepped(self) -> "SteadyMotion":
        x, y, _ = self.step
        cos, sin = np.cos(self.pose[2]), np.sin(self.pose[2])
        F = np.eye(6)
        F[0, 2], F[1, 2] = -sin * x - cos * y, cos * x - sin * y
        F[:3, 3:] = [[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]]
        return SteadyMotion(compose(self.pose, self.step), self.step, F @ self.P @ F.T)

    def matched(self, place: Array, covariance: Array) -> "SteadyMotion":
        """Return the motion if a match has the laser at `place` (3,), T_key_laser, to a `covariance` (3, 3)."""
        off = place - self.pose
        off[2] = wrap_angle(off[2])
        gain = np.linalg.solve(self.P[:3, :3] + covariance, self.P[:3]).T
        change, P = gain @ off, self.P - gain @ self.P[:3]
        return SteadyMotion(self.pose + change[:3], self.step + change[3:], 0.5 * (P + P.T))

    def slowed(self, share: float) -> "SteadyMotion":
        """Return the motion with its step a `share` of what it was."""
        scale = np.repeat([1.0, share], 3)
        return SteadyMotion(self.pose, share * self.step, scale[:, None] * self.P * scale)

    def since_here(self) -> "SteadyMotion":
        """Return the motion as seen from a keyframe at its pose."""
        P = np.zeros((6, 6))
        P[3:, 3:] = self.P[3:, 3:]
        return SteadyMotion(np.zeros(3), self.step, P)


def _sigma(covariance: Array) -> Array:
    """Return (2,) standard deviations by a `covariance` (3, 3): along the least known direction, and of the turn."""
    way = np.linalg.eigvalsh(covariance[:2, :2])[-1]
    return np.sqrt(np.maximum([way, covariance[2, 2]], 0.0))
