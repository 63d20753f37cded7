"""Joint compatibility by branch and bound, compiled: the search of Neira and Tardos (2001), their figure 3.

A hypothesis pairs some sightings with landmarks. Its squared Mahalanobis distance is `|w|^2` where `L w = y`, `L` being
the Cholesky factor of the joint innovation covariance. A pair more adds two rows to `L` and `w` and leaves the others,
so that each hypothesis of the search costs two rows, not a whole factorization.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]
Partners = NDArray[np.int64]


@njit(cache=True)
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


@njit(cache=True)
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
    order = np.empty((m, k), dtype=np.int64)
    candidates = np.zeros(m, dtype=np.int64)  # how many of a row's `order` are within the gate
    rows = np.empty(m, dtype=np.int64)
    n = 0
    for i in range(m):
        order[i] = np.argsort(distance[i])
        while candidates[i] < k and distance[i, order[i, candidates[i]]] <= gate:
            candidates[i] += 1
        if candidates[i]:
            rows[n] = i
            n += 1
    best, partner = np.full(m, -1, dtype=np.int64), np.full(m, -1, dtype=np.int64)
    taken = np.zeros(k, dtype=np.bool_)
    chosen_rows, chosen_columns = np.empty(n, dtype=np.int64), np.empty(n, dtype=np.int64)
    L, w = np.zeros((2 * n, 2 * n)), np.zeros(2 * n)
    totals = np.zeros(n + 1)  # joint distance of the first c pairs
    cursor = np.zeros(n + 1, dtype=np.int64)
    count, best_count, best_total, nodes, depth = 0, 0, np.inf, 0, 0
    entered = True
    while depth >= 0:
        if entered:
            nodes += 1
            if count and (count > best_count or (count == best_count and totals[count] < best_total)):
                best[:], best_count, best_total = partner, count, totals[count]
            if depth == n or nodes > most_nodes or count + n - depth < best_count:
                cursor[depth] = k + 1  # nothing follows from here
            else:
                cursor[depth] = 0
            entered = False
        if depth < n and partner[rows[depth]] >= 0:  # back from what this pair led to
            count -= 1
            taken[partner[rows[depth]]] = False
            partner[rows[depth]] = -1
        row = rows[depth] if depth < n else 0
        if depth == n or cursor[depth] > candidates[row]:
            depth -= 1
            continue
        place = cursor[depth]
        cursor[depth] += 1
        if place == candidates[row]:  # the last way: this sighting has no partner
            cursor[depth] = k + 1
            depth += 1
            entered = True
            continue
        column = order[row, place]
        if taken[column]:
            continue
        chosen_rows[count], chosen_columns[count] = row, column
        longer = totals[count] + _append(count, chosen_rows, chosen_columns, y, HPH, R, L, w)
        if longer <= bounds[min(2 * (count + 1), len(bounds) - 1)]:
            count += 1
            totals[count] = longer
            partner[row], taken[column] = column, True
            depth += 1
            entered = True
    return best


@njit(cache=True)
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
