"""Sparse pose adjustment: Levenberg-Marquardt over all poses of a graph (Konolige et al. 2010).

Why scipy: with an order of minimum degree on the poses its sparse LU takes 166 to 600 ms for the 3500 poses and 5453
edges of M3500b, gtsam 4.3 took 230 to 300 ms on the same busy machine, from the same start to the same optimum; and
gtsam is a wheel of 110 MB.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import SuperLU, splu

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
        pattern: Of the normal equations; None: there are no edges.
    """

    poses: Array
    cost: float
    iterations: Rounds
    converged: bool
    pattern: SparsityPattern | None = None


def adjust(graph: PoseGraph, config: AdjustmentConfig | None = None, fixed: int = 0) -> Adjustment:
    """Return the poses of least cost near those of the graph; the pose `fixed` stays."""
    config = config or AdjustmentConfig()
    if not len(graph.edges):
        return Adjustment(graph.poses.copy(), 0.0, 0, True)
    pattern = block_pattern(len(graph.poses), graph.edges)
    poses, damping = graph.poses.copy(), config.damping
    cost, data, gradient = linearised(graph, pattern, poses, fixed)
    for iteration in range(1, config.iterations + 1):
        step = _step(pattern, data, gradient, damping)
        trial = compose(poses, _exponential(step))
        trial_cost, trial_data, trial_gradient = linearised(graph, pattern, trial, fixed)
        if trial_cost <= cost:
            gain = cost - trial_cost
            poses, cost, data, gradient = trial, trial_cost, trial_data, trial_gradient
            damping = max(damping * 0.2, config.damping)
            if gain <= config.tolerance * cost + 1e-12:
                return Adjustment(poses, cost, iteration, True, pattern)
        else:
            damping = max(damping, 1e-6) * 5.0
            if damping > 1e6:
                return Adjustment(poses, cost, iteration, True, pattern)
    return Adjustment(poses, cost, config.iterations, False, pattern)


def linearised(graph: PoseGraph, pattern: SparsityPattern, poses: Array, fixed: int) -> tuple[float, Array, Array]:
    """Return the robust cost of a graph at `poses` (n, 3), the data of H and the gradient (3 n,), by block row."""
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


def _step(pattern: SparsityPattern, data: Array, gradient: Array, damping: float) -> Array:
    """Return (n, 3) the damped step of each pose, in its own frame."""
    return factorised(pattern, data, damping).solve(-gradient).reshape(-1, 3)[pattern.place]


def factorised(pattern: SparsityPattern, data: Array, damping: float) -> SuperLU:
    """Return the factors of H, damped by so much of its diagonal; of a pose that nothing moves they are those of 1."""
    damped, size = data.copy(), len(pattern.diagonal)
    diagonal = damped[pattern.diagonal]
    ceiling = np.median(diagonal)  # a stiff edge must not freeze the soft directions of its poses
    damped[pattern.diagonal] = np.where(diagonal > 0.0, diagonal + damping * np.minimum(diagonal, ceiling), 1.0)
    H = sparse.csc_matrix((damped, pattern.indices, pattern.indptr), shape=(size, size))
    return splu(H, permc_spec="NATURAL", diag_pivot_thresh=0.0, options={"SymmetricMode": True})


def _exponential(step: Array) -> Array:
    """Return (n, 3) the motions of twists (n, 3): a stiff edge between two poses that turn together stays satisfied."""
    half = 0.5 * step[:, 2]
    sine, cosine = np.sinc(half / np.pi) * np.cos(half), np.sinc(half / np.pi) * np.sin(half)
    x, y = sine * step[:, 0] - cosine * step[:, 1], cosine * step[:, 0] + sine * step[:, 1]
    return np.stack((x, y, step[:, 2]), axis=-1)
