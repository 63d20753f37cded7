"""Where a robot should be that was lost in a gap of the log, but not kidnapped."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry import between, compose

Array = NDArray[np.float64]

_SIGMAS, _STEP = 2.0, 0.5  # the odometry's errors over a gap: standard deviations, and metres that err alike


@dataclass(frozen=True, eq=False)
class SearchRegion:
    """Where the odometry may have led over a gap: a place farther away mostly looks alike only.

    Attributes:
        limits: (2,) by how much the odometry may be wrong over the gap [m, rad].
        start: (3,) T_map_robot by the odometry where the gap ended.
    """

    limits: Array
    start: Array

    @classmethod
    def across(cls, distance: float, sigma: Array, start: Array) -> "SearchRegion":
        """Return the region after a gap.

        Args:
            distance: Across the gap [m].
            sigma: (2,) standard deviations of the odometry if all its steps erred alike [m, rad], which they do not.
            start: (3,) T_map_robot by the odometry where the gap ended.
        """
        linear, angular = (_SIGMAS * sigma / np.sqrt(max(distance / _STEP, 1.0))).tolist()
        return cls(np.array([linear + 0.5 * distance * angular, angular]), start)

    def holds(self, pose: Array, expected: Array) -> bool:
        """Return whether the robot may well be at `pose` (3,) where the odometry has it at `expected` (3,) by now."""
        off = between(self.start, compose(pose, between(expected, self.start)))
        return bool(np.hypot(off[0], off[1]) <= self.limits[0] and abs(off[2]) <= self.limits[1])

    def widened(self, other: "SearchRegion") -> "SearchRegion":
        """Return the region after this gap and another one."""
        return SearchRegion(self.limits + other.limits, self.start)
