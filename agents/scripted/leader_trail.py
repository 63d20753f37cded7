"""Where the leader has gone: the places at which it was known, from the robot's to its own."""

import math
from collections import deque

import numpy as np
from numpy.typing import NDArray


class LeaderTrail:
    """Remembers the leader's way in the robot's present frame.

    Args:
        spacing: Distance between two points of the trail [m].
        step_s: Length of a control period [s].
    """

    def __init__(self, spacing: float, step_s: float) -> None:
        self._spacing, self._step_s = spacing, step_s
        self._points: deque[tuple[float, float]] = deque()

    def clear(self) -> None:
        """Forget it."""
        self._points.clear()

    def extend(self, x: float, y: float) -> None:
        """Take the leader's place now, robot frame [m]."""
        last = self._points[-1] if self._points else (math.inf, math.inf)
        if math.hypot(x - last[0], y - last[1]) > self._spacing:
            self._points.append((x, y))

    def carry_along(self, velocity: tuple[float, float, float]) -> None:
        """Move the trail from the last robot frame into the present one, by the robot's velocity [m/s, m/s, rad/s]."""
        dx, dy, turned = (v * self._step_s for v in velocity)
        cos, sin = math.cos(turned), math.sin(turned)
        moved = ((x - dx, y - dy) for x, y in self._points)
        self._points = deque((cos * x + sin * y, cos * y - sin * x) for x, y in moved)

    def aim(self, lookahead: float) -> tuple[float, float] | None:
        """Return the first point that is not nearer to the robot than `lookahead` [m]; those before are forgotten."""
        while self._points and math.hypot(*self._points[0]) < lookahead:
            self._points.popleft()
        return self._points[0] if self._points else None

    def ahead(self) -> NDArray[np.float64]:
        """Return (k, 2) the points from the one nearest to the robot on; those before are forgotten."""
        distances = [math.hypot(*point) for point in self._points]
        for _ in range(distances.index(min(distances)) if distances else 0):
            self._points.popleft()
        return np.array(self._points).reshape(-1, 2)
