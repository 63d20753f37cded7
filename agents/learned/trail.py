"""The leader's trail as the robot saw it, carried along in the moving robot frame."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SPACING_M = 0.1
LONGEST = 80
JUMP_M = 1.0
"""To a leader who is seen again farther than this from where the trail ends, the robot may go straight: a new trail."""


class Trail:
    """Where the leader walked and the robot has not been yet.

    Attributes:
        points: (k, 2) the oldest first, robot frame [m].
    """

    def __init__(self) -> None:
        self.points = np.zeros((0, 2))

    def update(self, velocity: tuple[float, float, float], step_s: float, leader: tuple[float, float] | None) -> None:
        """Go on by one step.

        Args:
            velocity: The robot's own (forward, left, turn) in the last step [m/s, m/s, rad/s].
            step_s: Its length [s].
            leader: Where the leader is, robot frame [m]; None while it is not seen.
        """
        dx, dy, turned = (value * step_s for value in velocity)
        cos, sin = np.cos(turned), np.sin(turned)
        moved = self.points - (dx, dy)
        self.points = np.stack((cos * moved[:, 0] + sin * moved[:, 1], cos * moved[:, 1] - sin * moved[:, 0]), axis=1)
        if leader is not None:
            last = self.points[-1] if len(self.points) else np.full(2, np.inf)
            apart = np.hypot(leader[0] - last[0], leader[1] - last[1])
            if apart > JUMP_M:
                self.points = np.array([leader])
            elif apart > SPACING_M:
                self.points = np.vstack((self.points, leader))[-LONGEST:]
        self._pass()

    def ahead(self, ways: Array) -> Array:
        """Return (k, 2) the points `ways` (k,) [m] along the trail from where the robot is nearest to it; its last
        point where it is shorter, and zeros without a trail."""
        if len(self.points) < 2:
            return np.repeat(self.points, len(ways), axis=0) if len(self.points) else np.zeros((len(ways), 2))
        arc = np.append(0.0, np.cumsum(np.hypot(*np.diff(self.points, axis=0).T)))
        return np.stack([np.interp(ways, arc, self.points[:, k]) for k in (0, 1)], axis=1)

    def _pass(self) -> None:
        """Drop what lies behind: all before the last point that is about as near as the nearest."""
        if len(self.points):
            off = np.hypot(self.points[:, 0], self.points[:, 1])
            self.points = (
                self.points[np.flatnonzero(off < max(0.4, off.min() + 0.1))[-1] :] if off.min() < 1.0 else (self.points)
            )
