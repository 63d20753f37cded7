"""Beams as a log has them, put into the order and the meaning of a `LaserScan`."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..geometry import wrap_angle

Array = NDArray[np.float64]

_BEHIND = 0.75 * np.pi  # a sweep that begins and ends farther than this from straight ahead is left as it is [rad]


def measured(ranges: Array, range_min: float = 0.0) -> Array:
    """Return `ranges` (N,) [m] with NaN where a driver wrote 0 for "no measurement" and `range_min` [m] is 0, too."""
    return np.where(ranges > 0.0, ranges, np.nan) if range_min <= 0.0 else ranges


def cut_behind(ranges: Any, bearings: Array, yaw: float = 0.0) -> tuple[Any, Array]:
    """Return a sweep's ranges and bearings (N,), those of a full circle such that it begins and ends behind the robot.

    Drivers that count from 0 to 2 pi cut the circle straight ahead, where a leg would fall into two pieces. Beams in
    the direction of one before, as of those that end where they began, are left out then.

    Args:
        ranges: (N,) [m], or whatever else each beam has.
        bearings: (N,) ascending [rad].
        yaw: How the laser is turned on the robot [rad].
    """
    span = bearings[-1] - bearings[0] if len(bearings) > 1 else 0.0
    step = span / max(len(bearings) - 1, 1)
    if span + 1.5 * step < 2.0 * np.pi or abs(wrap_angle(bearings[0] - 0.5 * step + yaw)) > _BEHIND:
        return ranges, bearings
    once = bearings < bearings[0] + 2.0 * np.pi - 0.5 * step
    first = float(wrap_angle(-np.pi - yaw))
    turned = first + (bearings[once] - first) % (2.0 * np.pi)
    order = np.argsort(turned, kind="stable")
    return ranges[once][order], turned[order]
