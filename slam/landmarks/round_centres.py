"""Where the centre of a round object is whose front a laser has met.

The mean of the visible points is not the centre, nor a fixed distance before it: which chords the beams cut depends on
the distance, and with beams a degree apart a post 6 m away is met by two of them, anywhere on it. What the sweep says
is more than a mean. Beams that hit bound the centre's bearing, so do the ones beside them that missed, and the arc of
the ranges tells where between the bounds it is. The posterior of that is integrated by Gauss-Legendre quadrature:
unbiased, with the covariance that errors really have (tests compare); from sweep to sweep they are independent.

Legend: D, beta distance and bearing of the centre from the laser; d the bearing of a beam against beta.
"""

import numpy as np
from numpy.typing import NDArray

from .centres_kernel import posterior_of_centres

Array = NDArray[np.float64]

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(9)
_LEAST = 0.05
"""Least half width of what the bearing may be, in spacings of the beams: the radius and the ranges are not exact."""


def round_centres(
    ranges: Array, bearings: Array, label: NDArray[np.int64], spacing: float, radius: float, sigma: float
) -> tuple[Array, Array]:
    """Return distance and bearing (m, 2) of the centres of m round objects and their covariances (m, 2, 2).

    Args:
        ranges: (k,) of the returns [m].
        bearings: (k,) of the same [rad].
        label: (k,) the object of each, 0 to m - 1, every one with a return at least. Beams beside an object missed it.
        spacing: Angle between neighbouring beams [rad].
        radius: Of the objects [m].
        sigma: Standard deviation of a range [m].
    """
    count = int(label.max()) + 1
    polar, covariance = np.empty((count, 2)), np.empty((count, 2, 2))
    posterior_of_centres(
        ranges, bearings, label, count, spacing, radius, sigma, _LEAST, _NODES, _WEIGHTS, polar, covariance
    )
    return polar, covariance


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
