"""The loops of the branch and bound, in numba; `exhaustive.py` is what they are compared with."""

import numba
import numpy as np

from .lanes import LANES, add_lanes


@numba.njit(cache=True, nogil=True)
def rotated_cells(points, headings, x, y, resolution, shift, cells):  # pragma: no cover
    """Write into `cells` (n_theta, N, 2) int32 the (row, column) of every point at every heading.

    Column = floor((cos px - sin py + x) / resolution) + shift, row likewise.
    """
    for k in range(len(headings)):
        cos, sin = np.cos(headings[k]), np.sin(headings[k])
        for n in range(len(points)):
            px, py = points[n, 0], points[n, 1]
            cells[k, n, 0] = np.int32(np.floor((sin * px + cos * py + y) / resolution)) + shift
            cells[k, n, 1] = np.int32(np.floor((cos * px - sin * py + x) / resolution)) + shift


@numba.njit(cache=True, nogil=True)
def top_bounds(phases, cells, blocks):  # pragma: no cover
    """Return (n_theta, blocks, blocks') int32, the sum over all points of level L at every block of the window.

    blocks' is `blocks` rounded up to a multiple of 16. Sums of up to 256 points are gathered in 16 bits.
    """
    stride, _, rows, cols = phases.shape
    flat = phases.ravel()
    n_theta, n_points, _ = cells.shape
    chunks = (blocks + LANES - 1) // LANES
    width = chunks * LANES
    bounds = np.zeros((n_theta, blocks, width), dtype=np.int32)
    plane = np.zeros(blocks * width, dtype=np.uint16)
    for k in range(n_theta):
        target = bounds[k].ravel()
        for first in range(0, n_points, 256):
            plane[:] = 0
            for n in range(first, min(first + 256, n_points)):
                row, col = cells[k, n, 0], cells[k, n, 1]
                row0, col0 = row // stride, col // stride
                if col0 >= cols or col0 + blocks <= 0:
                    continue
                phase = ((row % stride) * stride + col % stride) * rows
                inside = col0 >= 0 and col0 + width <= cols
                for a in range(max(0, -row0), min(blocks, rows - row0)):
                    source = (phase + row0 + a) * cols + col0
                    if inside:
                        for chunk in range(chunks):
                            add_lanes(plane, a * width + chunk * LANES, flat, source + chunk * LANES)  # pyright: ignore[reportCallIssue]
                    else:
                        for b in range(max(0, -col0), min(blocks, cols - col0)):
                            plane[a * width + b] += flat[source + b]
            for index in range(blocks * width):
                target[index] += plane[index]
    return bounds


@numba.njit(cache=True, nogil=True)
def block_sum(level, cells, i, j):  # pragma: no cover
    """Return the sum over the points at `cells` (N, 2), moved by (i, j) cells, of `level` (rows', cols')."""
    rows, cols = level.shape
    total = 0
    for n in range(len(cells)):
        row, col = cells[n, 0] + i, cells[n, 1] + j
        if 0 <= row < rows and 0 <= col < cols:
            total += np.int64(level[row, col])
    return total


@numba.njit(cache=True, nogil=True)
def nearest(low, size, centre):  # pragma: no cover
    """Return the square of the distance of `centre` to the nearest of low .. low + size - 1."""
    gap = max(0, low - centre, centre - (low + size - 1))
    return gap * gap


@numba.njit(cache=True, nogil=True)
def excluded(k, i, j, size, taken, reach, period):  # pragma: no cover
    """Return whether all of a block lies around a maximum in `taken` (m, 3), within `reach` = (headings, cells)."""
    for m in range(len(taken)):
        apart = abs(k - taken[m, 0])
        if period > 0:
            apart = min(apart, period - apart)
        if (
            apart <= reach[0]
            and i >= taken[m, 1] - reach[1]
            and i + size - 1 <= taken[m, 1] + reach[1]
            and j >= taken[m, 2] - reach[1]
            and j + size - 1 <= taken[m, 2] + reach[1]
        ):
            return True
    return False


@numba.njit(cache=True, nogil=True)
def descend(levels, cells, side, start, bound, taken, reach, period, best, stack):  # pragma: no cover
    """Search one top block, `start` = (k, i, j), depth first, best child first; write what beats `best` into it.

    `best` = (sum, rank, k, i, j); rank is the squared distance from the window's centre in steps, which decides
    between equal sums, then the lower (k, i, j) does. `stack` is room of (., 4) int64. Returns the blocks looked at.
    """
    n_theta, half = len(cells), side // 2
    k = start[0]
    rank_k = nearest(k, 1, n_theta // 2)
    stack[0, 0], stack[0, 1], stack[0, 2], stack[0, 3] = len(levels) - 1, start[1], start[2], bound
    depth, looked = 1, 0
    while depth > 0:
        depth -= 1
        level, i, j, total = stack[depth, 0], stack[depth, 1], stack[depth, 2], stack[depth, 3]
        size = 1 << level
        rank = rank_k + nearest(i, size, half) + nearest(j, size, half)
        if total < best[0] or (total == best[0] and rank > best[1]) or excluded(k, i, j, size, taken, reach, period):
            continue
        if level == 0:
            if total > best[0] or rank < best[1] or (k, i, j) < (best[2], best[3], best[4]):
                best[0], best[1], best[2], best[3], best[4] = total, rank, k, i, j
            continue
        size >>= 1
        first = depth
        for child in range(4):
            ci, cj = i + (child >> 1) * size, j + (child & 1) * size
            if ci >= side or cj >= side:
                continue
            total = block_sum(levels[level - 1], cells[k], ci, cj)
            looked += 1
            place = depth
            while place > first and stack[place - 1, 3] > total:
                for field in range(4):
                    stack[place, field] = stack[place - 1, field]
                place -= 1
            stack[place, 0], stack[place, 1], stack[place, 2], stack[place, 3] = level - 1, ci, cj, total
            depth += 1
    return looked


@numba.njit(cache=True, nogil=True)
def best_leaf(levels, cells, bounds, side, taken, reach, period, least):  # pragma: no cover
    """Return (sum, rank, k, i, j, blocks looked at) of the best candidate that is not around one in `taken`.

    The sum is -1 where none reaches `least`.
    """
    stride = 1 << (len(levels) - 1)
    stack = np.empty((3 * len(levels) + 4, 4), dtype=np.int64)
    n_theta, blocks, _ = bounds.shape
    best = np.array([least, np.int64(1) << 60, 0, 0, 0], dtype=np.int64)
    start = np.zeros(3, dtype=np.int64)
    looked = n_theta * blocks * blocks
    # The first dive, from the highest block, leaves few of the others to be looked at.
    highest = np.int64(-1)
    for k in range(n_theta):
        for a in range(blocks):
            for b in range(blocks):
                if bounds[k, a, b] > highest and not excluded(k, a * stride, b * stride, stride, taken, reach, period):
                    highest = np.int64(bounds[k, a, b])
                    start[0], start[1], start[2] = k, a * stride, b * stride
    if highest < least:
        best[0] = -1
        return best, looked
    looked += descend(levels, cells, side, start, highest, taken, reach, period, best, stack)
    left = np.flatnonzero(bounds.ravel() >= best[0])
    sums = bounds.ravel()[left]
    for index in left[np.argsort(-sums, kind="mergesort")]:
        k, a, b = index // (blocks * bounds.shape[2]), index // bounds.shape[2] % blocks, index % bounds.shape[2]
        if bounds[k, a, b] < best[0] or b >= blocks:
            continue
        start[0], start[1], start[2] = k, a * stride, b * stride
        looked += descend(levels, cells, side, start, bounds[k, a, b], taken, reach, period, best, stack)
    if best[1] == np.int64(1) << 60:
        best[0] = -1
    return best, looked
