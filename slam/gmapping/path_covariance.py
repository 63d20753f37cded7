"""How far off a pose may be, seen from where the drive began: by the matches that lead there.

Particles that survive agree, also where all of them err alike, so their spread does not tell. But each matched scan is
as far off as its match, and as the part of the map that it was matched with. That was drawn by the scan before, or,
where the robot has been before, by the most certain scan that shares its view.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class _View:
    """A pose (3,) from which a part of the map was drawn, and its covariance (3, 3), map frame [m, m, rad]."""

    pose: Array
    covariance: Array

    def carried_to(self, pose: Array) -> Array:
        """Return the covariance (3, 3) of a `pose` (3,) that is known exactly from here."""
        dx, dy, _ = (pose - self.pose).tolist()
        lever = np.array(((1.0, 0.0, -dy), (0.0, 1.0, dx), (0.0, 0.0, 1.0)))
        return lever @ self.covariance @ lever.T


class PathCovariance:
    """Covariances (3, 3) along a path of matched scans, map frame [m, m, rad]; the path begins where it is certain.

    Only the first scan of each view is kept, so that laps of a building cost no memory.

    Args:
        start: (3,) T_map_robot of the first scan.
        reach: Scans within this distance [m] share a view, if what they see overlaps by half.
    """

    def __init__(self, start: Array, reach: float) -> None:
        self._reach = reach
        self._views: dict[tuple[int, int], list[_View]] = {}  # by squares of that side, the oldest first
        self._last = _View(start, np.zeros((3, 3)))
        self._keep(self._last)

    def append(self, pose: Array, match: Array, field_of_view: float, fits: bool = True) -> None:
        """Take the next matched scan.

        Args:
            pose: (3,) T_map_robot.
            match: (3, 3) covariance of it on the map, or by the odometry since the last one where it does not fit.
            field_of_view: Of the laser [rad].
            fits: Whether it was matched with the map.
        """
        old = self._shared(pose, field_of_view) if fits else None
        self._last = _View(pose, (old or self._last).carried_to(pose) + match)
        if fits and old is None:
            self._keep(self._last)

    def at(self, pose: Array) -> Array:
        """Return the covariance (3, 3) of a `pose` (3,) that is known exactly from the last matched scan."""
        return self._last.carried_to(pose)

    def _shared(self, pose: Array, field_of_view: float) -> _View | None:
        """Return the most certain view that a scan shares."""
        x, y, heading = pose.tolist()
        i, j = self._square(pose)
        shared = [
            view
            for square in ((i + k, j + m) for k in (-1, 0, 1) for m in (-1, 0, 1))
            for view in self._views.get(square, ())
            if math.hypot(view.pose[0] - x, view.pose[1] - y) <= self._reach
            and abs(math.remainder(view.pose[2] - heading, math.tau)) <= 0.5 * field_of_view
        ]
        return min(shared, key=_variance, default=None)

    def _keep(self, view: _View) -> None:
        self._views.setdefault(self._square(view.pose), []).append(view)

    def _square(self, pose: Array) -> tuple[int, int]:
        return math.floor(pose[0] / self._reach), math.floor(pose[1] / self._reach)


def _variance(view: _View) -> float:
    """Return the variance of a view's position [m^2]."""
    return float(view.covariance[0, 0] + view.covariance[1, 1])
