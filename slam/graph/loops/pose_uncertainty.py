"""How far off the robot may be, seen from where the drive began: a covariance that each adjustment of the graph renews.

A scan is as far off as its match, and as the node that its submap hangs on: the one that began it, or the one that was
the newest when the graph was adjusted.
"""

import math
from collections import deque

import numpy as np
from numpy.typing import NDArray

from ...geometry import between, turning
from ...local.local_slam import Insertion, LocalResult
from ...pose_graph.marginal import marginal_covariances
from ...pose_graph.pose_graph import PoseGraph
from ...scan_to_grid.extrapolator import Prediction
from ...scan_to_grid.scan_matcher import GridMatch
from .optimisation import Optimised
from .submap_graph import SubmapGraph

Array = NDArray[np.float64]


class PoseUncertainty:
    """Covariances (3, 3) of the newest node, and of a node for each submap that grows, in their own frames [m, rad]."""

    def __init__(self) -> None:
        self._newest = np.zeros((3, 3))
        self._anchors = deque[tuple[Array, Array]](maxlen=2)  # T_local_node and covariance, of the older submap first

    def add_node(self, graph: SubmapGraph, insertion: Insertion) -> None:
        """Take in the newest node of a graph."""
        node, begins = graph.nodes[-1], len(graph.drawn[insertion.submaps[-1]]) == 1
        if begins and len(insertion.submaps) == 1:  # of a piece or a segment: only odometry leads there, if anything
            if len(graph.nodes) > 1:
                self._newest = self._carried(node.motion.pose, np.maximum(node.motion.sigma, insertion.drift))
            self._anchors.clear()
        else:
            self._newest = self._matched(node.pose_local, insertion.match, node.motion)
        if begins:
            self._anchors.append((node.pose_local, self._newest))

    def of(self, result: LocalResult, motion: Prediction) -> Array:
        """Return the covariance (3, 3) of a scan in its own frame.

        Args:
            result: What local SLAM made of it.
            motion: By the odometry from the newest node to it.
        """
        if result.match is None or not self._anchors:
            return self._carried(motion.pose, motion.sigma)
        return self._matched(result.pose, result.match, motion)

    def renew(self, graph: SubmapGraph, done: Optimised) -> None:
        """Take what a graph knows that was just optimised; pieces are tied as loosely as their slack says."""
        if done.pattern is None:
            return
        poses, information = done.poses, done.poses.information.copy()
        first = len(poses.edges) - len(graph.nodes) + 1  # of the edges from node to node
        for node, slack in graph.pieces.ties:
            sigma = np.maximum(graph.nodes[node].motion.sigma, [slack.linear, slack.angular])
            information[first + node - 1] = np.diag(sigma[[0, 0, 1]] ** -2.0)
        loose = PoseGraph(poses.poses, poses.edges, poses.measurements, information, poses.kernel_width)
        self._newest = marginal_covariances(loose, done.pattern, [len(poses.poses) - 1])[0]
        anchor = graph.nodes[-1].pose_local, self._newest
        self._anchors = deque([anchor] * len(self._anchors), maxlen=2)

    def _matched(self, pose: Array, match: GridMatch | None, motion: Prediction) -> Array:
        """Return the covariance of a scan at `pose` (3,), T_local_robot, on the older submap that grows.

        Where it stands there is known by the match, and by the motion from a scan that stands there, too.
        """
        (anchor, covariance), told = self._anchors[0], motion.information
        if match:
            turn = turning(pose.item(2))
            told = told + turn.T @ match.information @ turn
        return _seen_after(covariance, between(anchor, pose)) + np.linalg.inv(told)

    def _carried(self, way: Array, sigma: Array) -> Array:
        """Return the covariance after a `way` (3,) from the newest node, known to `sigma` (2,)."""
        return _seen_after(self._newest, way) + np.diag(sigma[[0, 0, 1]] ** 2)


def _seen_after(covariance: Array, way: Array) -> Array:
    """Return the covariance (3, 3) of a pose a `way` (3,) further on, which is known exactly, in the frame there."""
    x, y, turn = way.tolist()
    c, s = math.cos(turn), math.sin(turn)
    lever = np.array(((c, s, s * x - c * y), (-s, c, c * x + s * y), (0.0, 0.0, 1.0)))
    return lever @ covariance @ lever.T
