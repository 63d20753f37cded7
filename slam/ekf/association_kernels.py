"""Joint compatibility by branch and bound, compiled: the search of Neira and Tardos (2001), their figure 3.

A hypothesis pairs some sightings with landmarks. Its squared Mahalanobis distance is `|w|^2` where `L w = y`, `L` being
the Cholesky factor of the joint innovation covariance. A pair more adds two rows to `L` and `w` and leaves the others,
so that each hypothesis of the search costs two rows, not a whole factorization.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..view_kernel import kernel

Array = NDArray[np.float64]
Partners = NDArray[np.int64]


@kernel
def joint_distance(rows: Partners, columns: Partners, y: Array, HPH: Array, R: Array) -> float:
    """Return the squared Mahalanobis distance of the pairs (`rows[i]`, `columns[i]`) together.

    It is infinite where their joint covariance is not positive definite.

    Args:
        rows: (n,) sightings.
        columns: (n,) their landmarks.
        y: (m, k, 2) innovations of all pairs.
        HPH: (2k, 2k) covariance of the expected measurements.
        R: (m, 2, 2) noise of the sightings.
    """
    n = len(rows)
    L, w = np.zeros((2 * n, 2 * n)), np.zeros(2 * n)
    total = 0.0
    for i in range(n):
        total += _append(i, rows, columns, y, HPH, R, L, w)
    return total


@kernel
def largest_compatible(
    y: Array, HPH: Array, R: Array, distance: Array, gate: float, bounds: Array, most_nodes: int
) -> Partners:
    """Return (m,) the landmark of each sighting, -1 for none: the largest compatible set, then the nearest.

    Args:
        y: (m, k, 2) innovations.
        HPH: (2k, 2k) covariance of the expected measurements.
        R: (m, 2, 2) noise of the sightings.
        distance: (m, k) squared Mahalanobis distance of each pair alone.
        gate: The largest of them that a pair may have.
        bounds: Bound of the joint distance by degrees of freedom; the last holds for all above.
        most_nodes: After so many hypotheses none is made longer.
    """
    m, k = distance.shape
    inside = distance <= gate
    rows = np.flatnonzero(inside.sum(axis=1))
    n = len(rows)
    order = np.empty((n, k), dtype=np.int64)
    for i in range(n):
        order[i] = np.argsort(distance[rows[i]])
    search = _Search(
        rows,
        order,
        inside,
        np.full(n, -1, dtype=np.int64),
        np.full(n, -1, dtype=np.int64),
        np.zeros(k, dtype=np.bool_),
        np.zeros((2 * n, 2 * n)),
        np.zeros(2 * n),
        np.full(m, -1, dtype=np.int64),
        np.array([0.0, np.inf, 0.0]),
    )
    _explore(search, y, HPH, R, bounds, most_nodes)
    return search.best


class _Search(NamedTuple):
    """What one branch and bound works on; the arrays are written to.

    Attributes:
        rows: (n,) sightings that have a landmark within the gate.
        order: (n, k) landmarks by distance from each of them.
        inside: (m, k) whether a pair alone is within the gate.
        chosen_rows: (n,) sightings of the hypothesis in hand.
        chosen_columns: (n,) their landmarks.
        taken: (k,) which landmarks it uses.
        L: (2n, 2n) Cholesky factor of its joint covariance.
        w: (2n,) its whitened innovations.
        best: (m,) the best hypothesis so far, as landmark of each sighting.
        score: (3,) its number of pairs, its joint distance, and how many hypotheses were looked at.
    """

    rows: Partners
    order: Partners
    inside: NDArray[np.bool_]
    chosen_rows: Partners
    chosen_columns: Partners
    taken: NDArray[np.bool_]
    L: Array
    w: Array
    best: Partners
    score: Array


@kernel
def _explore(search: _Search, y: Array, HPH: Array, R: Array, bounds: Array, most: int) -> None:
    """Go through the hypotheses depth first: at each depth a sighting gets each landmark in turn, then none."""
    n, k = search.order.shape
    cursor = np.zeros(n + 1, dtype=np.int64)  # the next place in `order` to try at each depth; past k: all were tried
    paired = np.zeros(n + 1, dtype=np.bool_)  # whether what was tried last at each depth is a pair
    totals = np.zeros(n + 1)  # joint distance of the first so many pairs
    depth = count = 0
    cursor[0] = 0 if _go_on(search, 0, 0, 0.0, most) else k + 1
    while depth >= 0:
        if paired[depth]:
            count -= 1
            search.taken[search.chosen_columns[count]], paired[depth] = False, False
        if cursor[depth] > k:
            depth -= 1
            continue
        column = _next_landmark(search, depth, cursor)
        if column >= 0:
            search.chosen_rows[count], search.chosen_columns[count] = search.rows[depth], column
            grown = _append(count, search.chosen_rows, search.chosen_columns, y, HPH, R, search.L, search.w)
            if not totals[count] + grown <= bounds[min(2 * (count + 1), len(bounds) - 1)]:
                continue
            totals[count + 1] = totals[count] + grown
            count += 1
            search.taken[column], paired[depth] = True, True
        depth += 1
        cursor[depth] = 0 if _go_on(search, depth, count, totals[count], most) else k + 1


@kernel
def _next_landmark(search: _Search, depth: int, cursor: Partners) -> int:
    """Return the next landmark to try at a depth, -1 for the last way, none; move the depth's cursor past it."""
    row, k = search.rows[depth], search.order.shape[1]
    while cursor[depth] < k:
        column = search.order[depth, cursor[depth]]
        cursor[depth] += 1
        if not search.inside[row, column]:
            break
        if not search.taken[column]:
            return column
    cursor[depth] = k + 1
    return -1


@kernel
def _go_on(search: _Search, depth: int, count: int, total: float, most: int) -> bool:
    """Keep a hypothesis if it is the best so far; return whether a longer one could be better."""
    score, n = search.score, len(search.rows)
    score[2] += 1.0
    if count and (count > score[0] or (count == score[0] and total < score[1])):
        score[0], score[1] = count, total
        search.best[:] = -1
        for i in range(count):
            search.best[search.chosen_rows[i]] = search.chosen_columns[i]
    return depth < n and score[2] <= most and count + n - depth >= score[0]


@kernel
def _append(i: int, rows: Partners, columns: Partners, y: Array, HPH: Array, R: Array, L: Array, w: Array) -> float:
    """Add pair `i` to the factor `L` and to `w` of the pairs before it; return by how much |w|^2 grows."""
    added = 0.0
    for a in range(2):
        p = 2 * i + a
        rest = y[rows[i], columns[i], a]
        for q in range(p + 1):
            j, b = q // 2, q % 2
            value = HPH[2 * columns[i] + a, 2 * columns[j] + b]
            if j == i:
                value += R[rows[i], a, b]
            for s in range(q):
                value -= L[p, s] * L[q, s]
            if q < p:
                L[p, q] = value / L[q, q]
                rest -= L[p, q] * w[q]
            elif value > 0.0:
                L[p, p] = np.sqrt(value)
            else:
                return np.inf
        w[p] = rest / L[p, p]
        added += w[p] * w[p]
    return added
