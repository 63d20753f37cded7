"""Dijkstra's search over the cells of a floor, and the smoothing of what it finds.

The queue is one of buckets (Dial 1969): a step costs at least 1, so that cells whose prices have the same whole part
cannot improve each other, and may be settled in any order.
"""

import math

import numpy as np
from numpy.typing import NDArray

from ...slam.view_kernel import inner_view_kernel, kernel, view_kernel

Prices, Cells, Flags = NDArray[np.float64], NDArray[np.int64], NDArray[np.bool_]
Links = NDArray[np.int32]

_ROW = np.array([0, 0, 1, -1, 1, 1, -1, -1])
_COL = np.array([1, -1, 0, 0, 1, -1, 1, -1])
_DIAGONAL = 1.4142135623730951


def buckets_for(cost: Prices) -> int:
    """Return how many buckets a search needs where cells cost up to the largest finite one of `cost`."""
    return int(_DIAGONAL * np.max(cost, where=np.isfinite(cost), initial=1.0)) + 3


@view_kernel
def explore(
    cost: Prices,
    price: Prices,
    before: Cells,
    settled: Flags,
    links: Links,
    heads: Links,
    bucket: int,
    goal: int,
    limit: float,
) -> int:
    """Go on until the cell `goal` is settled, or all cells up to the price `limit` are, or none is left.

    A step between two of the eight neighbours costs its length in cells times the mean of both cells' cost. Of ways
    that cost the same, the one over the cell that is cheaper to reach counts, then that of the lower index.

    Args:
        cost: (rows, cols) price of a cell, at least 1; inf cannot be entered.
        price: (rows, cols) price of the cheapest way known, inf without one.
        before: (rows, cols) flat index of the cell before on it, -1 at the start and where there is none.
        settled: (rows, cols) whether no cheaper way can be found.
        links: (2, cells) the next and the previous cell in the same bucket, -1 for none.
        heads: (`buckets_for`,) first cell of each bucket, -1 for none; that of the price p is int(p) modulo them.
        bucket: Whole part of the least price that can be left.
        goal: Flat index of a cell; -1 for none.
        limit: A price.

    Returns:
        The same for the next call.
    """
    cols, empty = cost.shape[1], 0
    while bucket <= limit and empty < len(heads) and not (goal >= 0 and settled[goal // cols, goal % cols]):
        flat = heads[bucket % len(heads)]
        if flat < 0:
            bucket += 1
            empty += 1
            continue
        empty = 0
        _take_out(flat, bucket % len(heads), links, heads)
        settled[flat // cols, flat % cols] = True
        _look_around(cost, price, before, settled, links, heads, flat)
    return bucket - empty


@inner_view_kernel
def _look_around(
    cost: Prices, price: Prices, before: Cells, settled: Flags, links: Links, heads: Links, flat: int
) -> None:
    """Offer ways through the cell `flat`, which was settled, to its neighbours."""
    rows, cols = cost.shape
    r, c = flat // cols, flat % cols
    now, own = price[r, c], cost[r, c]
    for k in range(8):
        i, j = r + _ROW[k], c + _COL[k]
        if i < 0 or j < 0 or i >= rows or j >= cols or settled[i, j] or cost[i, j] == np.inf:
            continue
        reached, old = now + (1.0 if k < 4 else _DIAGONAL) * 0.5 * (own + cost[i, j]), price[i, j]
        if reached < old:
            cell = i * cols + j
            if old < np.inf:
                _take_out(cell, int(old) % len(heads), links, heads)
            price[i, j], before[i, j] = reached, flat
            _put_in(cell, int(reached) % len(heads), links, heads)
        elif reached == old:
            other = before[i, j]
            past = price[other // cols, other % cols]
            if now < past or (now == past and flat < other):
                before[i, j] = flat


@inner_view_kernel
def _put_in(cell: int, bucket: int, links: Links, heads: Links) -> None:
    first = heads[bucket]
    links[0, cell], links[1, cell], heads[bucket] = first, -1, cell
    if first >= 0:
        links[1, first] = cell


@inner_view_kernel
def _take_out(cell: int, bucket: int, links: Links, heads: Links) -> None:
    after, behind = links[0, cell], links[1, cell]
    if behind >= 0:
        links[0, behind] = after
    else:
        heads[bucket] = after
    if after >= 0:
        links[1, after] = behind


@kernel
def traced(before: Cells, goal: int, x0: float, y0: float, side: float) -> Prices:
    """Return (n, 2) the middles of the cells on the way to the cell `goal` [m].

    Args:
        before: (rows, cols) as in `explore`.
        goal: Flat index of a cell.
        x0: Middle of cell [0, 0] [m].
        y0: The same.
        side: Of a cell [m].
    """
    cols, count, flat = before.shape[1], 0, goal
    while flat >= 0:
        count, flat = count + 1, before[flat // cols, flat % cols]
    way, flat = np.empty((count, 2)), goal
    while flat >= 0:
        count -= 1
        way[count, 0], way[count, 1] = (flat % cols) * side + x0, (flat // cols) * side + y0
        flat = before[flat // cols, flat % cols]
    return way


@kernel
def nearest(points: NDArray[np.float64], x: float, y: float) -> int:
    """Return the row of `points` (n, 2) nearest to (x, y), the first of several; -1 of none."""
    best, least = -1, np.inf
    for i in range(len(points)):
        away = math.hypot(points[i, 0] - x, points[i, 1] - y)
        if away < least:
            best, least = i, away
    return best


@kernel
def apart(spots: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (n,) the distance of each of `spots` (n, 2) from the nearest of `points` (m, 2)."""
    least = np.empty(len(spots))
    for i in range(len(spots)):
        nearest_squared = np.inf
        for k in range(len(points)):
            dx, dy = spots[i, 0] - points[k, 0], spots[i, 1] - points[k, 1]
            nearest_squared = min(nearest_squared, dx * dx + dy * dy)
        least[i] = math.sqrt(nearest_squared)
    return least


@kernel
def smooth(
    points: NDArray[np.float64],
    clearance: NDArray[np.float64],
    x0: float,
    y0: float,
    resolution: float,
    least: float,
    rounds: int,
) -> NDArray[np.float64]:
    """Return `points` (n, 2) pulled towards the mean of their neighbours where that keeps clear; the ends stay.

    Args:
        points: (n, 2) a way [m].
        clearance: (rows, cols) distance of each cell from the next thing [m].
        x0: Outer corner of cell [0, 0] [m].
        y0: The same.
        resolution: Side of a cell [m].
        least: A point moves only to a cell with this clearance [m].
        rounds: How often every point is moved.
    """
    now = points.copy()
    rows, cols = clearance.shape
    for _ in range(rounds):
        old = now.copy()
        for k in range(1, len(points) - 1):
            x = 0.25 * old[k - 1, 0] + 0.5 * old[k, 0] + 0.25 * old[k + 1, 0]
            y = 0.25 * old[k - 1, 1] + 0.5 * old[k, 1] + 0.25 * old[k + 1, 1]
            col = min(max(int((x - x0) / resolution), 0), cols - 1)
            row = min(max(int((y - y0) / resolution), 0), rows - 1)
            if clearance[row, col] >= least:
                now[k, 0], now[k, 1] = x, y
    return now
