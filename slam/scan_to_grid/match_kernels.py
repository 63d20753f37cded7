"""Numba kernels of many scans on one submap: where a pose graph's nodes match, and what each match is worth."""

import numpy as np
from numpy.typing import NDArray

from ..view_kernel import kernel
from .refine_kernels import refine_many

Array = NDArray[np.float64]

_LEAST_INFORMATION = 1e-3  # [1/m^2, 1/rad^2] keeps degenerate directions invertible
_INDEPENDENT = 0.02  # share of a scan's points that count as independent of each other
_TRACK_ANGLES = 4  # steps of heading to each side


@kernel
def match_nodes(
    field: NDArray[np.float32],
    corner: Array,
    resolution: float,
    points: Array,
    firsts: NDArray[np.int64],
    T_local_submap: Array,
    T_global_submap: Array,
    T_global_node: Array,
    weight: float,
    wide: bool,
    max_shift: tuple[float, float],
    typical_score: float,
    min_score: float,
    sigma: tuple[float, float],
) -> tuple[NDArray[np.bool_], Array, Array, Array]:
    """Return whether each of n nodes matches near its place, its pose in the submap (n, 3), information and score.

    Args:
        field: (rows, cols) occupancy of the submap, as are its `corner` and `resolution`.
        corner: (2,) local frame [m].
        resolution: [m].
        points: (N, 2) of all nodes, robot frame [m].
        firsts: (n + 1,) those of node k are firsts[k] .. firsts[k + 1].
        T_local_submap: (3,) where the submap is drawn.
        T_global_submap: (3,) where the graph has it.
        T_global_node: (n, 3) where the graph has the nodes.
        weight: Of a point.
        wide: Whether to search the surroundings first.
        max_shift: How far a match may move [m, rad].
        typical_score: Of local matches.
        min_score: Least score, as a share of that.
        sigma: As of `information_in_node`.
    """
    n = len(T_global_node)
    relative, information = np.empty((n, 3)), np.zeros((n, 3, 3))
    starts = _starts(T_local_submap, T_global_submap, T_global_node)
    reach = int(np.ceil(max_shift[0] / resolution)) if wide else 0
    poses, curvatures, scores = refine_many(
        field, corner, resolution, points, firsts, starts, weight, reach, _TRACK_ANGLES, 0.8 * typical_score,
        0.7 * min_score * typical_score,
    )  # fmt: skip
    good = scores >= min_score * typical_score
    for k in range(n):
        x, y, turn = _between(starts[k], poses[k])
        good[k] &= np.hypot(x, y) <= max_shift[0] and abs(turn) <= max_shift[1]
        if good[k]:
            relative[k] = _between(T_local_submap, poses[k])
            information[k] = information_in_node(curvatures[k], relative[k, 2], sigma)
    return good, relative, information, scores


@kernel
def _starts(T_local_submap, T_global_submap, T_global_node):  # type: ignore[no-untyped-def]
    """Return (n, 3) where the graph has the nodes, in the local frame."""
    starts, c, s = np.empty_like(T_global_node), np.cos(T_local_submap[2]), np.sin(T_local_submap[2])
    for k in range(len(T_global_node)):
        x, y, turn = _between(T_global_submap, T_global_node[k])
        starts[k, 0] = T_local_submap[0] + c * x - s * y
        starts[k, 1] = T_local_submap[1] + s * x + c * y
        starts[k, 2] = _wrapped(T_local_submap[2] + turn)
    return starts


@kernel
def information_in_node(curvature: Array, heading: float, sigma: tuple[float, float]) -> Array:
    """Return (3, 3) information in the node's frame, from a curvature along the submap's axes and a least `sigma`.

    Args:
        curvature: (3, 3) information along the submap's axes.
        heading: Of the node in the submap [rad].
        sigma: Standard deviations that stand for what the curvature does not know [m, rad].
    """
    c, s, H = np.cos(heading), np.sin(heading), np.empty((3, 3))
    a, b, d = curvature[0, 0], 0.5 * (curvature[0, 1] + curvature[1, 0]), curvature[1, 1]
    u, v = 0.5 * (curvature[0, 2] + curvature[2, 0]), 0.5 * (curvature[1, 2] + curvature[2, 1])
    H[0, 0], H[1, 1] = c * c * a + 2.0 * c * s * b + s * s * d, s * s * a - 2.0 * c * s * b + c * c * d
    H[0, 1] = H[1, 0] = c * s * (d - a) + (c * c - s * s) * b
    H[0, 2] = H[2, 0] = c * u + s * v
    H[1, 2] = H[2, 1] = c * v - s * u
    H[2, 2] = curvature[2, 2]
    H *= _INDEPENDENT
    for k in range(3):
        H[k, k] += _LEAST_INFORMATION
    covariance = _inverse(H)
    covariance[0, 0] += sigma[0] ** 2
    covariance[1, 1] += sigma[0] ** 2
    covariance[2, 2] += sigma[1] ** 2
    return _inverse(covariance)


@kernel
def _inverse(A):  # type: ignore[no-untyped-def]
    """Return the inverse of a symmetric, positive definite matrix (3, 3)."""
    B = np.empty((3, 3))
    for i in range(3):
        for k in range(i, 3):
            p, q, r, t = (i + 1) % 3, (i + 2) % 3, (k + 1) % 3, (k + 2) % 3
            B[i, k] = B[k, i] = A[p, r] * A[q, t] - A[p, t] * A[q, r]
    return B / (A[0, 0] * B[0, 0] + A[0, 1] * B[0, 1] + A[0, 2] * B[0, 2])


@kernel
def _between(a, b):  # type: ignore[no-untyped-def]
    """Return the pose `b` (3,) seen from `a` (3,)."""
    c, s, dx, dy = np.cos(a[2]), np.sin(a[2]), b[0] - a[0], b[1] - a[1]
    return c * dx + s * dy, c * dy - s * dx, _wrapped(b[2] - a[2])


@kernel
def _wrapped(angle):  # type: ignore[no-untyped-def]
    return angle - 2.0 * np.pi * np.floor((angle + np.pi) / (2.0 * np.pi))
