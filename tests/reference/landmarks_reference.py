"""The plain numpy twins of the kernels that make landmarks of scans."""

import numpy as np
from numpy.typing import NDArray
from tagalong.slam.landmarks.round_centres import _LEAST, _NODES, _WEIGHTS

Array = NDArray[np.float64]


def heuristic_labels_reference(points: NDArray[np.float64], distance: float, min_points: int) -> NDArray[np.int64]:
    """Do what `heuristic_labels` does, in numpy."""
    cuts = (np.diff(points, axis=0) ** 2).sum(axis=1) > distance * distance
    runs = np.concatenate(([0], np.cumsum(cuts)))[: len(points)]
    big = np.bincount(runs) >= min_points
    return np.where(big, np.cumsum(big) - 1, -1)[runs]


def round_centres_reference(
    ranges: Array, bearings: Array, label: NDArray[np.int64], spacing: float, radius: float, sigma: float
) -> tuple[Array, Array]:
    """Return the same as `round_centres`, by arrays."""
    member = (label == np.arange(int(label.max()) + 1)[:, None]).astype(np.float64)
    count = member.sum(axis=1)
    first = np.where(member > 0.0, bearings, np.inf).min(axis=1)
    last = np.where(member > 0.0, bearings, -np.inf).max(axis=1)
    middle, half = 0.5 * (first + last), 0.5 * (last - first)
    D = member @ ranges / count + 0.25 * np.pi * radius
    D = _posterior(D, ranges, bearings, label, member, middle, half, spacing, radius, sigma)[0]
    D, centre, weight, off, free = _posterior(D, ranges, bearings, label, member, middle, half, spacing, radius, sigma)
    covariance = np.einsum("mj,maj,mbj->mab", weight, off, off)
    covariance[:, 0, 0] += sigma**2 / count
    covariance[:, 1, 1] += (free / len(_NODES)) ** 2 / 3.0  # finer than the nodes stand it cannot be known
    return np.stack((D, centre), axis=-1), covariance


def _posterior(
    D: Array,
    ranges: Array,
    bearings: Array,
    label: NDArray[np.int64],
    member: Array,
    middle: Array,
    half: Array,
    spacing: float,
    radius: float,
    sigma: float,
) -> tuple[Array, Array, Array, Array, Array]:
    """Return mean D and beta (m,), the nodes' weights (m, 9), how far the nodes are off the means (m, 2, 9),
    and the half width (m,) of what beta may be.

    `D` (m,) decides between which bounds beta lies: for a first guess of it call this twice.
    """
    width = np.arcsin(np.minimum(radius / D, 1.0))
    free = np.maximum(np.minimum(width - half, half + spacing - width), _LEAST * spacing)
    beta = middle[:, None] + free[:, None] * _NODES
    d = bearings[:, None] - beta[label]
    behind = np.sqrt(np.maximum(radius**2 - (D[label, None] * np.sin(d)) ** 2, 0.0))
    each = (ranges[:, None] + behind) / np.maximum(np.cos(d), 0.1)
    nodes = member @ each / member.sum(axis=1)[:, None]
    misfit = member @ (each - nodes[label]) ** 2 / sigma**2
    weight = _WEIGHTS * np.exp(-0.5 * (misfit - misfit.min(axis=1, keepdims=True)))
    weight /= weight.sum(axis=1, keepdims=True)
    mean_D, mean_beta = (weight * nodes).sum(axis=1), (weight * beta).sum(axis=1)
    return mean_D, mean_beta, weight, np.stack((nodes - mean_D[:, None], beta - mean_beta[:, None]), axis=1), free
