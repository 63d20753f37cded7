"""Along a smooth corridor whose end is out of the laser's reach a scan tells nothing of the way: odometry does.

Such a scan fits best where the walls were seen most often, which is behind the robot: scan after scan is drawn back a
little, and the corridor comes out too short, or the robot seems to stand (degenerate directions: Zhang, Kaess, Singh
2016). Where the end of the corridor is seen, scans hold the way well enough.
"""

import numpy as np
from numpy.typing import NDArray

from ..scan import LaserScan

Array = NDArray[np.float64]

_RUN = 9  # neighbouring points to which a piece of wall is fitted
_LONGEST_RUN = 3.0  # [m] between its ends; longer ones are no piece of wall
_LEAST_RUNS = 5
_BLIND = 0.08  # mean square of the walls' normals along a direction below which it is blind
_ASIDE = float(np.cos(np.radians(6.0)))  # beams within 6 degrees look along a direction
_LEAST_OPEN = 3  # beams along it without a return ...
_OPEN_RATIO = 2.0  # ... and more than so many for each that returns


def open_way(scan: LaserScan, points: Array) -> Array:
    """Return (2,) the direction along which a scan is blind and sees no end, robot frame; its length says how blind.

    The square of the length is 1 where no wall stands across that direction, and 0 where enough do, or where the scan
    sees an end.

    Args:
        scan: The scan.
        points: (N, 2) its thinned returns in the order of the beams, robot frame [m].
    """
    if not scan.is_no_return.any():
        return np.zeros(2)
    normals = _normals(points)
    if len(normals) < _LEAST_RUNS:
        return np.zeros(2)
    shares, directions = np.linalg.eigh(normals.T @ normals / len(normals))
    if shares[0] >= _BLIND or not _sees_no_end(scan, directions[:, 0]):
        return np.zeros(2)
    return directions[:, 0] * np.sqrt(1.0 - max(shares[0], 0.0) / _BLIND)


def _normals(points: Array) -> Array:
    """Return (m, 2) unit normals of the lines through runs of neighbouring points."""
    if len(points) < _RUN:
        return np.zeros((0, 2))
    x, y = points.T
    sums = np.cumsum(np.stack((x, y, x * x, y * y, x * y)), axis=1)
    sums = np.concatenate((np.zeros((5, 1)), sums), axis=1)
    mean_x, mean_y, xx, yy, xy = (sums[:, _RUN:] - sums[:, :-_RUN]) / _RUN
    tangent = 0.5 * np.arctan2(2.0 * (xy - mean_x * mean_y), (xx - mean_x**2) - (yy - mean_y**2))
    ends = points[_RUN - 1 :] - points[: len(points) - _RUN + 1]
    tangent = tangent[np.hypot(ends[:, 0], ends[:, 1]) < _LONGEST_RUN]
    return np.stack((-np.sin(tangent), np.cos(tangent)), axis=-1)


def _sees_no_end(scan: LaserScan, direction: Array) -> bool:
    """Return whether most of the beams that look along `direction` (2,), robot frame, either way, meet nothing."""
    bearings = scan.bearings + scan.T_robot_lidar[2]
    along = np.abs(np.cos(bearings) * direction[0] + np.sin(bearings) * direction[1]) > _ASIDE
    nothing, something = int((scan.is_no_return & along).sum()), int((scan.is_return & along).sum())
    return nothing >= _LEAST_OPEN and nothing > _OPEN_RATIO * something
