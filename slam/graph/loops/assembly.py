"""The pose graph of submaps, nodes and what ties them."""

import numpy as np
from numpy.typing import NDArray

from ...pose_graph.pose_graph import PoseGraph
from .constraints import Constraint, Kind
from .node import Node

Array = NDArray[np.float64]


def assemble(
    poses: Array,
    nodes: list[Node],
    constraints: list[Constraint],
    odometry_share: float,
    kernel_width: float,
) -> PoseGraph:
    """Return the graph of all submaps, then all nodes; its edges are the constraints, then the odometry between nodes.

    Args:
        poses: (s + n, 3) T_global_submap of all submaps, then T_global_node of all nodes.
        nodes: The nodes.
        constraints: What ties nodes to submaps.
        odometry_share: Share of its information with which odometry ties a node to the one before.
        kernel_width: Of the odometry and of INTER constraints, in standard deviations.
    """
    first, steps = len(poses) - len(nodes), nodes[1:]
    ties = np.array([(c.submap, first + c.node) for c in constraints], dtype=np.int64).reshape(-1, 2)
    chain = first + np.arange(len(steps))
    sigma = np.array([node.motion.sigma for node in steps]).reshape(-1, 2)
    motions = np.zeros((len(steps), 3, 3))
    motions[:, 0, 0] = motions[:, 1, 1] = odometry_share * sigma[:, 0] ** -2.0
    motions[:, 2, 2] = odometry_share * sigma[:, 1] ** -2.0
    widths = [np.inf if c.kind is Kind.INTRA else kernel_width for c in constraints]
    return PoseGraph(
        poses,
        np.concatenate((ties, np.stack((chain, chain + 1), axis=-1))),
        np.array([c.pose for c in constraints] + [node.motion.pose for node in steps]).reshape(-1, 3),
        np.concatenate((np.array([c.information for c in constraints]).reshape(-1, 3, 3), motions)),
        np.array(widths + [kernel_width] * len(steps)),
    )
