"""The plain numpy twin of the kernel that fills in the normal equations."""

import numpy as np
from numpy.typing import NDArray
from tagalong.slam.geometry import between
from tagalong.slam.pose_graph.pose_graph import PoseGraph

Array = NDArray[np.float64]


def normal_equations(graph: PoseGraph, fixed: int) -> tuple[float, Array, Array]:
    """Return the robust cost, the gradient (n, 3) and the dense H (3n, 3n) by steps in the frame of each pose.

    The error of an edge is z^-1 x_i^-1 x_j; a step of pose j in its own frame adds to it turned by the error's angle, a
    step of pose i moves x_i^-1 x_j by minus the step and its lever.
    """
    n, errors = len(graph.poses), graph.errors()
    H, gradient, cost = np.zeros((3 * n, 3 * n)), np.zeros((n, 3)), 0.0
    for k, (i, j) in enumerate(graph.edges):
        z, seen = graph.measurements[k], between(graph.poses[i], graph.poses[j])
        jacobian = np.zeros((3, 3 * n))
        if j != fixed:
            jacobian[:, 3 * j : 3 * j + 3] = _turn(errors[k, 2])
        if i != fixed:
            lever = np.array([[1.0, 0.0, -seen[1]], [0.0, 1.0, seen[0]], [0.0, 0.0, 1.0]])
            jacobian[:, 3 * i : 3 * i + 3] = -_turn(-z[2]) @ lever
        squared, width = errors[k] @ graph.information[k] @ errors[k], graph.kernel_width[k]
        robust = np.isfinite(width)
        weight = 1.0 / (1.0 + squared / width**2) if robust else 1.0
        cost += 0.5 * (width**2 * np.log1p(squared / width**2) if robust else squared)
        H += weight * jacobian.T @ graph.information[k] @ jacobian
        gradient += (weight * jacobian.T @ graph.information[k] @ errors[k]).reshape(n, 3)
    return float(cost), gradient, H


def _turn(angle: float) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
