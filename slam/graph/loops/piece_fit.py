"""Whether a whole piece of the drive agrees with what was mapped before it, if it lies where one stretch of it fits.

A building repeats itself: a stretch that was never seen may look like one that was. But then the rest of the piece runs
through walls.
"""

import numpy as np
from numpy.typing import NDArray

from ...geometry import between, compose, inverse
from ...local.submap_kernels import beams, passes_wall
from ...view_kernel import kernel
from .submap_graph import SubmapGraph

Array = NDArray[np.float64]

_EVERY = 1.0  # [m] of the drive after which a scan is looked at again
_LEAST_SUPPORT = 10.0  # so many beams must end at a wall for each that comes through one; where right, 16 and more do
_SLACK_M = 0.4  # a wall must stand so far before the end of a beam to be in its way
_TRACE, _NEAR = 0.15, 2  # occupancy of a wall, and cells around the end of a beam within which it counts


def agrees(graph: SubmapGraph, submaps: list[int], node: int, pose: Array, max_distance: float) -> bool:
    """Return whether the piece of a node agrees with some submaps if the node is at `pose` (3,), global frame.

    Args:
        graph: The graph.
        submaps: Those of before the piece.
        node: The node.
        pose: T_global_node.
        max_distance: Submaps whose middle is farther off a node say nothing of it [m].
    """
    shift = compose(pose, inverse(graph.nodes[node].pose_local))
    ends, passes, last = 0, 0, None
    centres = graph.centres[submaps]
    for k in range(graph.pieces.first_node(node), node + 1):
        at = compose(shift, graph.nodes[k].pose_local)
        if last is not None and np.hypot(at[0] - last[0], at[1] - last[1]) < _EVERY:
            continue
        last = at
        distance = np.hypot(centres[:, 0] - at[0], centres[:, 1] - at[1])
        nearest = int(np.argmin(distance))
        if distance[nearest] <= max_distance:
            submap = graph.submaps[submaps[nearest]]
            local = compose(submap.pose_local, between(graph.submap_poses[submaps[nearest]], at))
            sensor = np.array(graph.nodes[k].scan.T_robot_lidar[:2], dtype=np.float64)
            place = submap.field, submap.corner, submap.resolution
            told = ends_and_passes(*place, sensor, graph.nodes[k].points, local)
            ends, passes = ends + told[0], passes + told[1]
    return ends >= _LEAST_SUPPORT * passes


@kernel
def ends_and_passes(
    field: NDArray[np.float32], corner: Array, resolution: float, sensor: Array, points: Array, pose: Array
) -> tuple[int, int]:
    """Return how many beams that end at `points` (N, 2), the robot at `pose` (3,), end at walls and come through some.

    Args:
        field: (rows, cols) occupancy in [0, 1].
        corner: (2,) centre of cell [0, 0] [m].
        resolution: Side of a cell [m].
        sensor: (2,) place of the laser, robot frame [m].
        points: Robot frame [m].
        pose: In the frame of the field.
    """
    rows, cols = field.shape
    x0, y0, x, y = beams(points, sensor, pose, corner, resolution)
    ends = passes = 0
    for n in range(len(points)):
        if passes_wall(field, x0, y0, x[n], y[n], _SLACK_M / resolution):
            passes += 1
            continue
        i, j = int(np.floor(y[n])), int(np.floor(x[n]))
        if 0 <= i < rows and 0 <= j < cols:
            around = field[max(i - _NEAR, 0) : i + _NEAR + 1, max(j - _NEAR, 0) : j + _NEAR + 1]
            ends += around.max() >= _TRACE
    return ends, passes
