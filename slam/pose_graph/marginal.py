"""How well an adjusted graph knows single poses: their marginal covariances (Kaess, Dellaert 2009)."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .adjustment import factorised, linearised
from .normal_equations import SparsityPattern
from .pose_graph import PoseGraph

Array = NDArray[np.float64]

_DAMPING = 1e-12  # of the diagonal: what hardly anything ties must not make the equations singular


def marginal_covariances(graph: PoseGraph, pattern: SparsityPattern, wanted: Sequence[int], fixed: int = 0) -> Array:
    """Return (k, 3, 3) how far each of the poses `wanted` may be off, seen from the pose `fixed`, in its own frame.

    Measurements count as much as the robust kernels let them where the poses are now [m, m, rad].

    Args:
        graph: Adjusted.
        pattern: Of its normal equations, `block_pattern`.
        wanted: Which poses.
        fixed: It is known.
    """
    _, data, gradient = linearised(graph, pattern, graph.poses, fixed)
    factors = factorised(pattern, data, _DAMPING)
    covariances = np.zeros((len(wanted), 3, 3))
    for k, pose in enumerate(wanted):
        if pose != fixed:
            first = 3 * pattern.place.item(pose)
            unit = np.zeros((len(gradient), 3))
            unit[first : first + 3] = np.eye(3)
            covariances[k] = factors.solve(unit)[first : first + 3]
    return 0.5 * (covariances + covariances.swapaxes(1, 2))
