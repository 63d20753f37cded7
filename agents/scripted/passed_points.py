"""What has just left the laser's view, as points: the tail of a robot that turns must miss it."""

import numpy as np
from numpy.typing import NDArray

from ...envs.task.interface import FollowInterface

Array = NDArray[np.float64]


class PassedPoints:
    """Remembers returns that the laser met a moment ago and does not look at any longer.

    Args:
        interface: Where the laser sits and which way it looks.
        seconds: How long they are remembered: what passes the tail does so in this time, and people go on [s].
    """

    def __init__(self, interface: FollowInterface, seconds: float = 3.0) -> None:
        self._interface, self._seconds = interface, seconds
        self.reset()

    def reset(self) -> None:
        """Forget all."""
        self._points, self._unseen_s = np.empty((0, 2)), np.empty(0)

    def update(self, points: Array, velocity: tuple[float, float, float]) -> Array:
        """Return (n, 2) the `points` (k, 2) met now and those out of view, in the robot's present frame [m].

        Args:
            points: In that frame [m].
            velocity: Of the robot, forward, left and turn, since the last call [m/s, m/s, rad/s].
        """
        step_s = 1.0 / self._interface.control_hz
        dx, dy, turned = (v * step_s for v in velocity)
        cos, sin = np.cos(turned), np.sin(turned)
        moved = (self._points - (dx, dy)) @ np.array(((cos, -sin), (sin, cos)))
        unseen_s = self._unseen_s + step_s
        kept = self._out_of_view(moved) & (unseen_s < self._seconds)
        self._points = np.vstack((moved[kept], points))
        self._unseen_s = np.concatenate((unseen_s[kept], np.zeros(len(points))))
        return self._points

    def _out_of_view(self, points: Array) -> NDArray[np.bool_]:
        x, y, _ = self._interface.T_robot_lidar
        return self._interface.along_scan(np.arctan2(points[:, 1] - y, points[:, 0] - x)) > 1.0
