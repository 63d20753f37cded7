"""The optimisation of the graph: all poses are adjusted to the constraints, and wrong constraints are dropped."""

from typing import NamedTuple

import numpy as np

from ...pose_graph.adjustment import adjust
from ...pose_graph.normal_equations import SparsityPattern
from ...pose_graph.pose_graph import PoseGraph
from ...pose_log import PoseLog
from .assembly import assemble
from .global_config import GlobalSlamConfig
from .submap_graph import SubmapGraph

_WORST = 0.5  # of the worst distance: from there on they are dropped at once, for a wrong tie pulls right ones along


class Optimised(NamedTuple):
    """What came of an optimisation.

    Attributes:
        rejected: How many INTER constraints were dropped.
        poses: The graph as it was adjusted.
        pattern: Of its normal equations; None: nothing ties its poses.
    """

    rejected: int
    poses: PoseGraph
    pattern: SparsityPattern | None


def optimise(graph: SubmapGraph, config: GlobalSlamConfig, final: bool = False) -> Optimised:
    """Adjust all poses of a graph.

    An INTER constraint that the adjusted graph contradicts is dropped, and the graph is adjusted again, until none is.

    Args:
        graph: The graph; its poses and constraints are changed.
        config: Settings.
        final: Whether the drive is over: then constraints must agree with the graph within `final_residual`, too.
    """
    share, width, rejected = config.odometry_share, config.kernel_width, 0
    placed = np.concatenate((graph.submap_poses.array(), graph.node_poses.array()))
    poses = assemble(placed, graph.nodes, graph.constraints, share, width)
    while True:
        adjusted = adjust(poses, config.adjustment)
        poses = poses.with_poses(adjusted.poses)
        error, count = poses.errors(), len(graph.constraints)
        distance = np.sqrt(poses.squared_distances(error))
        bad = distance > config.reject_beyond
        if final:
            bad |= np.hypot(error[:, 0], error[:, 1]) > config.final_residual[0]
            bad |= np.abs(error[:, 2]) > config.final_residual[1]
        bad &= np.isfinite(poses.kernel_width)  # not of INTRA
        bad[count:] = False  # the odometry between nodes stays: wheels slip, but it is all that ties some of them
        if not bad.any():
            break
        bad &= distance >= _WORST * distance[bad].max()
        graph.constraints = [c for c, wrong in zip(graph.constraints, bad[:count].tolist(), strict=True) if not wrong]
        rejected += int(bad.sum())
        poses = poses.with_edges(~bad)
    submaps = len(graph.submap_poses)
    graph.submap_poses, graph.node_poses = PoseLog.of(poses.poses[:submaps]), PoseLog.of(poses.poses[submaps:])
    graph.moved()
    return Optimised(rejected, poses, adjusted.pattern)
