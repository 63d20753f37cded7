"""Which points of a scan can tell where the robot is: those that fall where the submap has seen something.

What a scan sees for the first time fits nowhere yet. If it counted as a misfit, every match would be drawn towards what
is known: a robot that comes into a new room, or drives backwards with a laser that looks ahead, would lag behind. But
nothing is seen through a wall: where a beam would have to, its end speaks against the pose, known or not.
"""

import numpy as np
from numpy.typing import NDArray

from ..scan_to_grid.extrapolator import Prediction
from ..view_kernel import kernel
from .submap import Submap
from .submap_kernels import beams, passes_wall

Array = NDArray[np.float64]

_LOOKS = 4  # cells to each side that are looked at, about
_SLACK_M = 0.4  # a wall must stand so far before the end of a beam to be in its way


def seen_points(submap: Submap, points: Array, prediction: Prediction) -> Array:
    """Return those of `points` (N, 2), robot frame [m], that a submap may have seen before.

    A point may be off by a cell and by a standard deviation of the prediction, the farther away the more by its turn.
    """
    place = submap.visits, submap.corner, submap.resolution
    return points[near_visits(*place, points, prediction.pose, *prediction.sigma.tolist())]


@kernel
def near_visits(
    visits: NDArray[np.float32],
    corner: Array,
    resolution: float,
    points: Array,
    pose: Array,
    linear: float,
    angular: float,
) -> NDArray[np.bool_]:
    """Return (N,) whether there is a cell with visits near each of `points`, the robot at `pose`.

    Near is what is beside its cell, or within `linear` [m] and what a turn by `angular` [rad] moves the point. Of many
    cells, some are looked at: what scans have seen is no single cell.
    """
    rows, cols = visits.shape
    c, s = np.cos(pose[2]), np.sin(pose[2])
    near = np.zeros(len(points), np.bool_)
    for n in range(len(points)):
        x = (pose[0] + c * points[n, 0] - s * points[n, 1] - corner[0]) / resolution + 0.5
        y = (pose[1] + s * points[n, 0] + c * points[n, 1] - corner[1]) / resolution + 0.5
        j, i = int(np.floor(x)), int(np.floor(y))
        reach = 1 + int((linear + angular * np.hypot(points[n, 0], points[n, 1])) / resolution)
        step = 1 + reach // _LOOKS
        for row in range(max(i - reach, 0), min(i + reach + 1, rows), step):
            for col in range(max(j - reach, 0), min(j + reach + 1, cols), step):
                if visits[row, col] > 0:
                    near[n] = True
                    break
            if near[n]:
                break
    return near


def telling_share(submap: Submap, points: Array, sensor: Array, pose: Array) -> float:
    """Return the share of `points` (N, 2), robot frame [m], that speak for or against the robot being at `pose` (3,).

    Those do that fall where the submap has seen something, and those that only a beam through a wall could have seen.

    Args:
        submap: Where the scan is thought to be.
        points: (N, 2) robot frame [m].
        sensor: (2,) place of the laser, robot frame [m].
        pose: (3,) T_local_robot.
    """
    place = submap.field, submap.visits, submap.corner, submap.resolution
    return telling(*place, sensor, points, pose) / max(1, len(points))


@kernel
def telling(
    field: NDArray[np.float32],
    visits: NDArray[np.float32],
    corner: Array,
    resolution: float,
    sensor: Array,
    points: Array,
    pose: Array,
) -> int:
    """Return how many of `points` (N, 2) lie in or beside a cell with visits, or behind a wall, the robot at `pose`."""
    x0, y0, x, y = beams(points, sensor, pose, corner, resolution)
    near = near_visits(visits, corner, resolution, points, pose, 0.0, 0.0)
    count = 0
    for n in range(len(points)):
        count += near[n] or passes_wall(field, x0, y0, x[n], y[n], _SLACK_M / resolution)
    return count
