"""Dijkstra's search over the cells of a floor, and the smoothing of what it finds."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

Prices, Cells, Flags = NDArray[np.float64], NDArray[np.int64], NDArray[np.bool_]

NEIGHBOURS = 8
_ROW = np.array([0, 0, 1, -1, 1, 1, -1, -1])
_COL = np.array([1, -1, 0, 0, 1, -1, 1, -1])


@njit(cache=True, nogil=True)
def explore(
    cost: Prices,
    price: Prices,
    before: Cells,
    settled: Flags,
    heap: tuple[Prices, Cells],
    size: int,
    goal: int,
    limit: float,
) -> int:
    """Go on until the cell `goal` is settled, or all cells up to the price `limit` are, or the heap is full.

    A step between two of the eight neighbours costs its length in cells times the mean of both cells' cost.

    Args:
        cost: (rows, cols) price of a cell; inf cannot be entered.
        price: (rows, cols) price of the cheapest way known, inf without one.
        before: (rows, cols) flat index of the cell before on it, -1 at the start and where there is none.
        settled: (rows, cols) whether no cheaper way can be found.
        heap: (h,) prices of the cells to be looked at, lowest first, and (h,) their flat indices; full when there is no
            room for the `NEIGHBOURS` of one more cell.
        size: How many there are.
        goal: Flat index of a cell; -1 for none.
        limit: A price.

    Returns:
        How many cells are left to be looked at.
    """
    cols = cost.shape[1]
    heap_prices, heap_cells = heap
    if goal >= 0 and settled[goal // cols, goal % cols]:
        return size
    while size > 0 and heap_prices[0] <= limit and size + NEIGHBOURS <= len(heap_prices):
        now, flat = float(heap_prices[0]), int(heap_cells[0])
        size -= 1
        _sink(heap_prices, heap_cells, size)
        r, c = flat // cols, flat % cols
        if settled[r, c]:
            continue
        settled[r, c] = True
        size = _look_around(cost, price, before, settled, heap, size, now, flat)
        if flat == goal:
            break
    return size


@njit(cache=True, nogil=True)
def _look_around(
    cost: Prices,
    price: Prices,
    before: Cells,
    settled: Flags,
    heap: tuple[Prices, Cells],
    size: int,
    now: float,
    flat: int,
) -> int:
    """Offer ways through the cell `flat`, settled at the price `now`, to its neighbours; return the heap's new size."""
    rows, cols = cost.shape
    r, c = flat // cols, flat % cols
    for k in range(NEIGHBOURS):
        i, j = r + _ROW[k], c + _COL[k]
        if i < 0 or j < 0 or i >= rows or j >= cols or settled[i, j] or not np.isfinite(cost[i, j]):
            continue
        length = 1.0 if k < 4 else 1.4142135623730951
        reached = float(now + length * 0.5 * (cost[r, c] + cost[i, j]))
        if reached < price[i, j]:
            price[i, j] = reached
            before[i, j] = flat
            _rise(heap[0], heap[1], size, reached, i * cols + j)
            size += 1
    return size


@njit(cache=True, nogil=True)
def _rise(prices: NDArray[np.float64], cells: NDArray[np.int64], at: int, price: float, cell: int) -> None:
    """Put an entry into the heap of `at` entries."""
    while at > 0:
        up = (at - 1) >> 1
        if prices[up] < price or (prices[up] == price and cells[up] <= cell):
            break
        prices[at], cells[at] = prices[up], cells[up]
        at = up
    prices[at], cells[at] = price, cell


@njit(cache=True, nogil=True)
def _sink(prices: NDArray[np.float64], cells: NDArray[np.int64], size: int) -> None:
    """Fill the hole at the top of the heap with its last entry, the one at `size`."""
    price, cell = prices[size], cells[size]
    at = 0
    while True:
        down = 2 * at + 1
        if down >= size:
            break
        right = down + 1
        if right < size and (
            prices[right] < prices[down] or (prices[right] == prices[down] and cells[right] < cells[down])
        ):
            down = right
        if price < prices[down] or (price == prices[down] and cell <= cells[down]):
            break
        prices[at], cells[at] = prices[down], cells[down]
        at = down
    prices[at], cells[at] = price, cell


@njit(cache=True, nogil=True)
def nearest(points: NDArray[np.float64], x: float, y: float) -> int:
    """Return the row of `points` (n, 2) nearest to (x, y), the first of several; -1 of none."""
    best, least = -1, np.inf
    for i in range(len(points)):
        away = np.hypot(points[i, 0] - x, points[i, 1] - y)
        if away < least:
            best, least = i, away
    return best


@njit(cache=True, nogil=True)
def apart(spots: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (n,) the distance of each of `spots` (n, 2) from the nearest of `points` (m, 2)."""
    least = np.empty(len(spots))
    for i in range(len(spots)):
        nearest_squared = np.inf
        for k in range(len(points)):
            dx, dy = spots[i, 0] - points[k, 0], spots[i, 1] - points[k, 1]
            nearest_squared = min(nearest_squared, dx * dx + dy * dy)
        least[i] = np.sqrt(nearest_squared)
    return least


@njit(cache=True, nogil=True)
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
