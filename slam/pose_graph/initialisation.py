"""First poses of a graph by chordal rotation averaging, which needs no guess (Carlone et al. 2015)."""

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import splu

from ..errors import InputError
from .pose_graph import PoseGraph

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]


def initialise(graph: PoseGraph, fixed: int = 0) -> PoseGraph:
    """Return the graph at poses that are computed from its measurements alone; the pose `fixed` stays.

    Headings: the unit numbers u_j = u_i exp(i dtheta) in the least-squares sense, each scaled back to length 1. Then
    the positions that fit the measured translations under these headings. Both are linear, hence have no wrong optima.

    Raises:
        InputError: If the measurements do not tie all poses together, or one has no information of its angle or place.
    """
    weights = np.stack(
        (graph.information[:, 2, 2], 0.5 * (graph.information[:, 0, 0] + graph.information[:, 1, 1])), axis=-1
    )
    if not (weights > 0.0).all():
        raise InputError("measurements of a graph that is initialised need positive information of angle and place")
    poses = graph.poses.copy()
    i, j = graph.edges.T
    ties = sparse.coo_matrix((np.ones(len(i)), (i, j)), shape=(len(poses), len(poses)))
    pieces = connected_components(ties, directed=False, return_labels=False)
    if pieces > 1:
        raise InputError(f"a graph is initialised as a whole, got {pieces} pieces that no measurement ties together")
    turns = np.exp(1j * graph.measurements[:, 2])
    start = np.exp(1j * poses[fixed, 2])
    units = _solve(len(poses), graph.edges, weights[:, 0], turns, np.zeros(len(i), complex), fixed, start)
    poses[:, 2] = np.angle(units)
    moved = (graph.measurements[:, 0] + 1j * graph.measurements[:, 1]) * np.exp(1j * poses[i, 2])
    origin = complex(poses[fixed, 0], poses[fixed, 1])
    places = _solve(len(poses), graph.edges, weights[:, 1], np.ones(len(i), complex), moved, fixed, origin)
    poses[:, 0], poses[:, 1] = places.real, places.imag
    return graph.with_poses(poses)


def _solve(
    n: int, edges: NDArray[np.int64], weights: Array, factors: Complex, offsets: Complex, fixed: int, value: complex
) -> Complex:
    """Return (n,) complex v with v[fixed] = value of least sum w |v_j - factor v_i - offset|^2."""
    rows = np.arange(len(edges))
    root = np.sqrt(weights)
    A = sparse.coo_matrix(
        (
            np.concatenate((root, -root * factors)),
            (np.concatenate((rows, rows)), np.concatenate((edges[:, 1], edges[:, 0]))),
        ),
        shape=(len(edges), n),
    ).tocsc()
    free = np.flatnonzero(np.arange(n) != fixed)
    rest = root * offsets - A[:, [fixed]].toarray().ravel() * value
    B = A[:, free]
    solution = np.full(n, value, dtype=complex)
    H = (B.conj().T @ B).tocsc()
    solution[free] = splu(H, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0).solve(B.conj().T @ rest)
    return solution
