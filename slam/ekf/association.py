"""Which sighting is of which landmark: nearest neighbour, or joint compatibility (Neira, Tardos 2001).

Legend: m sightings, k landmarks; y the innovation of a pair, S its covariance.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment
from scipy.stats import chi2

from ..geometry import wrap_angle
from .association_kernels import joint_distance, largest_compatible

Array = NDArray[np.float64]
Pairs = list[tuple[int, int]]

_GATES = chi2.ppf(0.99, np.arange(0, 201))
"""99 % bounds of the squared Mahalanobis distance by degrees of freedom."""
MOST_NODES = 600
"""Joint compatibility looks at so many hypotheses at most, and keeps the best of them."""


@dataclass(frozen=True, eq=False)
class Innovations:
    """All pairs of sightings and landmarks.

    Attributes:
        y: (m, k, 2) innovations, bearings wrapped.
        HPH: (2k, 2k) covariance of the expected measurements of all landmarks together.
        R: (m, 2, 2) noise of the sightings.
        distance: (m, k) squared Mahalanobis distances.
    """

    y: Array
    HPH: Array
    R: Array
    distance: Array


def compare(z: Array, R: Array, expected: Array, HPH: Array) -> Innovations:
    """Compare sightings `z` (m, 2) of noise `R` with `expected` (k, 2), of covariance `HPH` (2k, 2k)."""
    k = len(expected)
    y = z[:, None] - expected[None]
    y[..., 1] = wrap_angle(y[..., 1])
    blocks = HPH.reshape(k, 2, k, 2)[np.arange(k), :, np.arange(k), :]
    S = blocks[None] + R[:, None]
    determinant = S[..., 0, 0] * S[..., 1, 1] - S[..., 0, 1] * S[..., 1, 0]
    distance = (
        S[..., 1, 1] * y[..., 0] ** 2 - 2.0 * S[..., 0, 1] * y[..., 0] * y[..., 1] + S[..., 0, 0] * y[..., 1] ** 2
    ) / determinant
    return Innovations(y, HPH, R, distance)


def nearest_neighbour(pairs: Innovations, gate: float) -> Pairs:
    """Return the pairs (sighting, landmark) of smallest total distance among those within `gate`, one to one."""
    if not pairs.distance.size:
        return []
    rows, columns = linear_sum_assignment(np.minimum(pairs.distance, gate + 1e-9))
    return [(int(i), int(j)) for i, j in zip(rows, columns, strict=True) if pairs.distance[i, j] <= gate]


def joint_compatibility(pairs: Innovations, gate: float) -> Pairs:
    """Return the largest set of pairs that is compatible as a whole; among equals the one of smallest distance.

    Branch and bound in depth first order over the sightings. `gate` holds for each pair; the whole has its 99 % bound.
    """
    if not pairs.distance.size:
        return []
    nearest = nearest_neighbour(pairs, gate)
    rows, columns = np.array(nearest, dtype=np.int64).reshape(-1, 2).T
    joint = joint_distance(rows, columns, pairs.y, pairs.HPH, pairs.R)
    if joint <= _GATES[min(2 * len(nearest), len(_GATES) - 1)] and not _ambiguous(pairs, gate):
        return nearest
    best = largest_compatible(pairs.y, pairs.HPH, pairs.R, pairs.distance, gate, _GATES, MOST_NODES)
    return [(int(i), int(best[i])) for i in np.flatnonzero(best >= 0)]


def _ambiguous(pairs: Innovations, gate: float) -> bool:
    """Return whether a sighting or a landmark has two partners within the gate."""
    close = pairs.distance <= gate
    return bool((close.sum(axis=0) > 1).any() or (close.sum(axis=1) > 1).any())
