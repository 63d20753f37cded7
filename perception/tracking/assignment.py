"""Numba kernels of the assignment of least total cost (Munkres; shortest augmenting paths, Crouse, "On implementing 2D
rectangular assignment algorithms", IEEE TAES 52(4), 2016), in the order of scipy's `linear_sum_assignment`: ties too.
"""

import numpy as np

from ...slam.view_kernel import inner_kernel, kernel


@kernel
def near_pairs(cost, limit):
    """Return the rows and the columns of `cost` (n, m) with an entry below the row's `limit` (n,), and whether alone.

    Alone: none has more than one such entry; then rows and columns are pairs.
    """
    n, m = cost.shape
    partner = np.full(n, -1)
    wanted = np.zeros(m, np.int64)
    alone = True
    count = 0
    for i in range(n):
        for j in range(m):
            if cost[i, j] < limit[i]:
                alone = alone and partner[i] < 0 and wanted[j] == 0
                count += partner[i] < 0
                partner[i] = j
                wanted[j] += 1
    rows = np.empty(count, np.int64)
    k = 0
    for i in range(n):
        if partner[i] >= 0:
            rows[k] = i
            k += 1
    if alone:
        return rows, partner[rows], True
    return rows, np.flatnonzero(wanted), False


@inner_kernel
def _free_column(cost, row, u, v, path, row_of, shortest, rows_met, columns_met):
    """Walk from `row` along the cheapest ways to a column that is nobody's; return it and what the way costs."""
    count = cost.shape[1]
    rows_met[:], columns_met[:], shortest[:] = False, False, np.inf
    left = np.arange(count - 1, -1, -1)
    least, i = 0.0, row
    while True:
        rows_met[i] = True
        nearest, lowest = -1, np.inf
        for k in range(count):
            j = left[k]
            way = least + cost[i, j] - u[i] - v[j]
            if way < shortest[j]:
                path[j], shortest[j] = i, way
            if shortest[j] < lowest or (shortest[j] == lowest and row_of[j] < 0):
                lowest, nearest = shortest[j], k
        least, j = lowest, left[nearest]
        columns_met[j] = True
        count -= 1
        left[nearest] = left[count]
        if row_of[j] < 0:
            return j, least
        i = row_of[j]


@inner_kernel
def _columns_of(cost):
    """Return (n,) the column of each row of finite `cost` (n, m), n <= m, at the least total."""
    n, m = cost.shape
    u, v, shortest = np.zeros(n), np.zeros(m), np.empty(m)
    path, column_of, row_of = np.full(m, -1), np.full(n, -1), np.full(m, -1)
    rows_met, columns_met = np.empty(n, np.bool_), np.empty(m, np.bool_)
    for row in range(n):
        j, least = _free_column(cost, row, u, v, path, row_of, shortest, rows_met, columns_met)
        u[row] += least
        for i in range(n):
            if rows_met[i] and i != row:
                u[i] += least - shortest[column_of[i]]
        for k in range(m):
            if columns_met[k]:
                v[k] -= least - shortest[k]
        i = -1
        while i != row:
            i = path[j]
            row_of[j], column_of[i], j = i, j, column_of[i]
    return column_of


@kernel
def assigned(cost, limit):
    """Return the pairs (rows, columns) of least total `cost` (n, m), where row i pays `limit` (n,) to stay unmatched.

    Pairs at or beyond the limit are no pairs; entries may be infinite.
    """
    rows, columns, alone = near_pairs(cost, limit)
    if alone:  # nobody wants what another wants: nothing to decide
        return rows, columns
    tall = len(columns) < len(rows)
    gain = np.empty((len(columns), len(rows)) if tall else (len(rows), len(columns)))
    for i in range(len(rows)):
        for j in range(len(columns)):
            value = min(cost[rows[i], columns[j]] - limit[rows[i]], 0.0)
            if tall:
                gain[j, i] = value
            else:
                gain[i, j] = value
    chosen = _columns_of(gain)
    if tall:
        partner = np.full(len(rows), -1)
        for j in range(len(columns)):
            partner[chosen[j]] = j
    else:
        partner = chosen
    count = 0
    first, second = np.empty(len(rows), np.int64), np.empty(len(rows), np.int64)
    for i in range(len(rows)):
        j = partner[i]
        if j >= 0 and cost[rows[i], columns[j]] < limit[rows[i]]:
            first[count], second[count] = rows[i], columns[j]
            count += 1
    return first[:count], second[:count]
