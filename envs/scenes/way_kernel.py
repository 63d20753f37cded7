"""Dijkstra's search over the cells of a floor, and the smoothing of what it finds."""

import heapq

import numpy as np
from numba import njit
from numpy.typing import NDArray

_ROW = np.array([0, 0, 1, -1, 1, 1, -1, -1])
_COL = np.array([1, -1, 0, 0, 1, -1, 1, -1])


@njit(cache=True, nogil=True)
def search(cost: NDArray[np.float64], row: int, col: int) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return the cheapest way from one cell to every other.

    A step between two of the eight neighbours costs its length in cells times the mean of both cells' cost.

    Args:
        cost: (rows, cols) price of a cell; inf cannot be entered.
        row: Of the start.
        col: Of the start.

    Returns:
        (rows, cols) price of the cheapest way, inf without one; (rows, cols) flat index of the cell before on it, -1
        at the start and where there is none.
    """
    rows, cols = cost.shape
    price = np.full((rows, cols), np.inf)
    before = np.full((rows, cols), -1, dtype=np.int64)
    price[row, col] = 0.0
    heap = [(0.0, row * cols + col)]  # of (price, flat index)
    while len(heap) > 0:
        now, flat = heapq.heappop(heap)
        r, c = flat // cols, flat % cols
        if now > price[r, c]:
            continue
        for k in range(8):
            i, j = r + _ROW[k], c + _COL[k]
            if i < 0 or j < 0 or i >= rows or j >= cols or not np.isfinite(cost[i, j]):
                continue
            length = 1.0 if k < 4 else 1.4142135623730951
            reached = float(now + length * 0.5 * (cost[r, c] + cost[i, j]))
            if reached < price[i, j]:
                price[i, j] = reached
                before[i, j] = flat
                heapq.heappush(heap, (reached, i * cols + j))
    return price, before


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
