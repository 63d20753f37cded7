"""Degenerate directions: those along which the walls of a scan do not constrain the pose (Zhang, Kaess, Singh 2016).

In a smooth corridor whose end is out of the laser's reach only the odometry tells how far the robot has driven. Such a
scan fits best where the walls were seen most often, which is behind the robot: scan after scan would be drawn back a
little, and the corridor come out too short. Where the end of the corridor is seen, scans constrain the pose well.
"""

import math

import numpy as np
from numpy.typing import NDArray

from ..scan import LaserScan
from ..view_kernel import kernel

Array = NDArray[np.float64]

_RUN = 9  # neighbouring points to which a line along a wall is fitted
_LONGEST_RUN = 3.0  # [m] between its ends; longer ones are no single wall
_LEAST_RUNS = 5
_DEGENERATE = 0.08  # mean square of the walls' normals along a direction below which it is degenerate
_ASIDE = float(np.cos(np.radians(6.0)))  # beams within 6 degrees look along a direction
_LEAST_OPEN = 3  # beams along it without a return ...
_OPEN_RATIO = 2.0  # ... and more than so many for each that returns


def degenerate_direction(scan: LaserScan, points: Array) -> Array:
    """Return (2,) the degenerate direction of a scan, robot frame; its length says how degenerate it is.

    The square of the length is 1 where no wall stands across that direction, and 0 where enough do, or where the scan
    sees an end.

    Args:
        scan: The scan.
        points: (N, 2) its thinned returns in the order of the beams, robot frame [m].
    """
    if not scan.is_open.any():
        return np.zeros(2)
    runs, cos, sin = _twice_directions(points)
    if runs < _LEAST_RUNS:
        return np.zeros(2)
    share, angle = 0.5 * (1.0 - math.hypot(cos, sin) / runs), 0.5 * math.atan2(sin, cos)
    direction = np.array((math.cos(angle), math.sin(angle)))
    if share >= _DEGENERATE or not _sees_no_end(scan, direction):
        return np.zeros(2)
    return direction * math.sqrt(1.0 - max(share, 0.0) / _DEGENERATE)


@kernel
def _twice_directions(points: Array) -> tuple[int, float, float]:
    """Return how many runs of neighbouring `points` (N, 2) there are, and the sums of cos 2a and sin 2a over them.

    Each run lies along a line in the direction a. With n runs, that sum has the direction 2d and the length R; of the
    runs' normals, d is the direction with the least mean square, (1 - R / n) / 2.
    """
    runs, cos, sin = 0, 0.0, 0.0
    for first in range(len(points) - _RUN + 1):
        last = first + _RUN - 1
        if np.hypot(points[last, 0] - points[first, 0], points[last, 1] - points[first, 1]) >= _LONGEST_RUN:
            continue
        x = y = xx = yy = xy = 0.0
        for k in range(first, last + 1):
            dx, dy = points[k, 0] - points[first, 0], points[k, 1] - points[first, 1]
            x, y, xx, yy, xy = x + dx, y + dy, xx + dx * dx, yy + dy * dy, xy + dx * dy
        along, across = (xx - yy) - (x * x - y * y) / _RUN, 2.0 * (xy - x * y / _RUN)
        length = np.hypot(along, across)
        if length > 0.0:
            runs, cos, sin = runs + 1, cos + along / length, sin + across / length
    return runs, cos, sin


def _sees_no_end(scan: LaserScan, direction: Array) -> bool:
    """Return whether most of the beams that look along `direction` (2,), robot frame, either way, meet nothing."""
    bearings = scan.bearings + scan.T_robot_lidar[2]
    along = np.abs(np.cos(bearings) * direction[0] + np.sin(bearings) * direction[1]) > _ASIDE
    nothing, something = int((scan.is_open & along).sum()), int((scan.is_return & along).sum())
    return nothing >= _LEAST_OPEN and nothing > _OPEN_RATIO * something
