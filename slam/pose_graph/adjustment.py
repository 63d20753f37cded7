"""Sparse pose adjustment: Levenberg-Marquardt over all poses of a graph (Konolige et al. 2010).

Why scipy: with an order of minimum degree on the poses its sparse LU takes 166 to 600 ms for the 3500 poses and 5453
edges of M3500b, gtsam 4.3 took 230 to 300 ms on the same busy machine, from the same start to the same optimum; and
gtsam is a wheel of 110 MB.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

from ..bounds import Rounds, check_numbers, check_positive
from ..geometry import compose
from .normal_equations import SparsityPattern, block_pattern, fill
from .pose_graph import PoseGraph

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class AdjustmentConfig:
    """Settings of `adjust`.

    Attributes:
        iterations: Most steps.
        tolerance: Ends when a step lowers the cost by less than this share of it.
        damping: Damping at the start, relative to the diagonal.
    """

    iterations: Rounds = 50
    tolerance: float = 1e-7
    damping: float = 1e-8

    def __post_init__(self) -> None:
        check_numbers(self)
        check_positive(self)


@dataclass(frozen=True, eq=False)
class Adjustment:
    """What an adjustment found.

    Attributes:
        poses: (n, 3) adjusted T_w_i.
        cost: Half the sum of robust squared distances.
        iterations: Steps tried.
        converged: Whether it ended by the tolerance.
    """

    poses: Array
    cost: float
    iterations: Rounds
    converged: bool


def adjust(graph: PoseGraph, config: AdjustmentConfig | None = None, fixed: int = 0) -> Adjustment:
    """Return the poses of least cost near those of the graph; the pose `fixed` stays."""
    config = config or AdjustmentConfig()
    if not len(graph.edges):
        return Adjustment(graph.poses.copy(), 0.0, 0, True)
    pattern = block_pattern(len(graph.poses), graph.edges)
    poses, damping = graph.poses.copy(), config.damping
    cost, data, gradient = _linearize(graph, pattern, poses, fixed)
    for iteration in range(1, config.iterations + 1):
        step = _solve(pattern, data, gradient, damping)
        trial = compose(poses, _exponential(step))
        trial_cost, trial_data, trial_gradient = _linearize(graph, pattern, trial, fixed)
        if trial_cost <= cost:
            gain = cost - trial_cost
            poses, cost, data, gradient = trial, trial_cost, trial_data, trial_gradient
            damping = max(damping * 0.2, config.damping)
            if gain <= config.tolerance * cost + 1e-12:
                return Adjustment(poses, cost, iteration, True)
        else:
            damping = max(damping, 1e-6) * 5.0
            if damping > 1e6:
                return Adjustment(poses, cost, iteration, True)
    return Adjustment(poses, cost, config.iterations, False)


def _linearize(graph: PoseGraph, pattern: SparsityPattern, poses: Array, fixed: int) -> tuple[float, Array, Array]:
    data, gradient = np.empty(len(pattern.indices)), np.empty(poses.size)
    cost = fill(
        poses,
        graph.edges,
        graph.measurements,
        graph.information,
        graph.kernel_width,
        fixed,
        pattern.place,
        pattern.base,
        pattern.stride,
        pattern.edge_blocks,
        data,
        gradient,
    )
    return cost, data, gradient


def _solve(pattern: SparsityPattern, data: Array, gradient: Array, damping: float) -> Array:
    """Return (n, 3) the damped step of each pose, in its own frame."""
    damped = data.copy()
    diagonal = damped[pattern.diagonal]
    ceiling = np.median(diagonal)  # a stiff edge must not freeze the soft directions of its poses
    damped[pattern.diagonal] = np.where(diagonal > 0.0, diagonal + damping * np.minimum(diagonal, ceiling), 1.0)
    size = len(gradient)
    H = sparse.csc_matrix((damped, pattern.indices, pattern.indptr), shape=(size, size))
    options = {"SymmetricMode": True}
    step = splu(H, permc_spec="NATURAL", diag_pivot_thresh=0.0, options=options).solve(-gradient)
    return step.reshape(-1, 3)[pattern.place]


def _exponential(step: Array) -> Array:
    """Return (n, 3) the motions of twists (n, 3): a stiff edge between two poses that turn together stays satisfied."""
    half = 0.5 * step[:, 2]
    sine, cosine = np.sinc(half / np.pi) * np.cos(half), np.sinc(half / np.pi) * np.sin(half)
    x, y = sine * step[:, 0] - cosine * step[:, 1], cosine * step[:, 0] + sine * step[:, 1]
    return np.stack((x, y, step[:, 2]), axis=-1)
