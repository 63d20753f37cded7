"""A stretch of the drive: what was seen on the last metres, as one cloud of points."""

import numpy as np
from numpy.typing import NDArray

from ...geometry import between, transform_points
from ...scan_to_grid.voxel_filter import voxel_first
from .submap_graph import SubmapGraph

Array = NDArray[np.float64]

STRETCH = 6.0  # [m] on which local SLAM drifts by less than a wall is thick
_VOXEL = 0.15  # [m]


def stretch(graph: SubmapGraph, node: int) -> Array:
    """Return (N, 2) what was seen on the last metres of the way to a node, in the frame of its robot [m]."""
    pose, way = graph.nodes[node].pose_local, 0.0
    clouds = [graph.nodes[node].points]
    for k in range(node - 1, graph.pieces.first_node(node) - 1, -1):
        x, y, _ = between(graph.nodes[k].pose_local, graph.nodes[k + 1].pose_local).tolist()
        way += float(np.hypot(x, y))
        if way > STRETCH:
            break
        clouds.append(transform_points(between(pose, graph.nodes[k].pose_local), graph.nodes[k].points))
    points = np.concatenate(clouds)
    return points[voxel_first(points, _VOXEL)]
