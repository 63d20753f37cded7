"""Which sighting is of which landmark: nearest neighbour, or joint compatibility (Neira, Tardos 2001).

Legend: m sightings, k landmarks; y the innovation of a pair, S its covariance.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, cho_factor, cho_solve
from scipy.optimize import linear_sum_assignment
from scipy.stats import chi2

from ..geometry import wrap_angle

Array = NDArray[np.float64]
Pairs = list[tuple[int, int]]

_GATES = chi2.ppf(0.99, np.arange(0, 201))
"""99 % bounds of the squared Mahalanobis distance by degrees of freedom."""
MOST_NODES = 600
"""Joint compatibility looks at so many hypotheses at most, and keeps the best of them."""


@dataclass(frozen=True, eq=False)
class Comparison:
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


def compare(z: Array, R: Array, expected: Array, HPH: Array) -> Comparison:
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
    return Comparison(y, HPH, R, distance)


def nearest_neighbour(pairs: Comparison, gate: float) -> Pairs:
    """Return the pairs (sighting, landmark) of smallest total distance among those within `gate`, one to one."""
    if not pairs.distance.size:
        return []
    rows, columns = linear_sum_assignment(np.minimum(pairs.distance, gate + 1e-9))
    return [(int(i), int(j)) for i, j in zip(rows, columns, strict=True) if pairs.distance[i, j] <= gate]


def joint_compatibility(pairs: Comparison, gate: float) -> Pairs:
    """Return the largest set of pairs that is compatible as a whole; among equals the one of smallest distance.

    Branch and bound in depth first order over the sightings. `gate` holds for each pair; the whole has its 99 % bound.
    """
    if not pairs.distance.size:
        return []
    nearest = nearest_neighbour(pairs, gate)
    if _joint_distance(pairs, nearest) <= _GATES[min(2 * len(nearest), 200)] and not _ambiguous(pairs, gate):
        return nearest
    search = _Search(pairs, gate)
    search.descend(0, [], 0.0)
    return search.best


class _Search:
    """The state of one branch and bound."""

    def __init__(self, pairs: Comparison, gate: float) -> None:
        self.pairs, self.gate = pairs, gate
        self.best: Pairs = []
        self.distance = np.inf
        self.nodes = 0
        self.rows = [i for i in range(len(pairs.distance)) if (pairs.distance[i] <= gate).any()]

    def descend(self, depth: int, chosen: Pairs, distance: float) -> None:
        """Try all that can follow `chosen`, of joint `distance`, from the row `depth` on."""
        self.nodes += 1
        better = len(chosen) > len(self.best) or (len(chosen) == len(self.best) and distance < self.distance)
        if chosen and better:
            self.best, self.distance = list(chosen), distance
        if depth == len(self.rows) or self.nodes > MOST_NODES:
            return
        if len(chosen) + len(self.rows) - depth < len(self.best):
            return
        row = self.rows[depth]
        taken = {j for _, j in chosen}
        for j in np.argsort(self.pairs.distance[row]).tolist():
            if self.pairs.distance[row, j] > self.gate:
                break
            if j in taken:
                continue
            longer = [*chosen, (row, j)]
            joint = _joint_distance(self.pairs, longer)
            if joint <= _GATES[min(2 * len(longer), 200)]:
                self.descend(depth + 1, longer, joint)
        self.descend(depth + 1, chosen, distance)


def _joint_distance(pairs: Comparison, chosen: Pairs) -> float:
    """Return the squared Mahalanobis distance of all `chosen` pairs together."""
    if not chosen:
        return 0.0
    rows = np.array([i for i, _ in chosen])
    columns = np.array([[2 * j, 2 * j + 1] for _, j in chosen]).ravel()
    S = pairs.HPH[np.ix_(columns, columns)].copy()
    for place, row in enumerate(rows):
        S[2 * place : 2 * place + 2, 2 * place : 2 * place + 2] += pairs.R[row]
    y = pairs.y[rows, columns[::2] // 2].ravel()
    try:
        return float(y @ cho_solve(cho_factor(S, check_finite=False), y, check_finite=False))
    except LinAlgError:
        return np.inf


def _ambiguous(pairs: Comparison, gate: float) -> bool:
    """Return whether a sighting or a landmark has two partners within the gate."""
    close = pairs.distance <= gate
    return bool((close.sum(axis=0) > 1).any() or (close.sum(axis=1) > 1).any())
