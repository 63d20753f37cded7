"""The loops of the branch and bound, in numba; `exhaustive.py` is what they are compared with."""

import numpy as np

from ..view_kernel import kernel
from .lanes import LANES, add_lanes


@kernel
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


@kernel
def _add_clipped(plane, flat, start, row0, col0, blocks, width, rows, cols):  # pragma: no cover
    """Add to `plane` what lies inside of a level (rows, cols) of a window that reaches beyond its border."""
    for a in range(max(0, -row0), min(blocks, rows - row0)):
        for b in range(max(0, -col0), min(blocks, cols - col0)):
            plane[a * width + b] += flat[start + a * cols + b]


@kernel
def top_bounds(phases, skirt, border, cells, blocks):  # pragma: no cover
    """Return (n_theta, blocks, blocks') int32, the sum over all points of level L at every block of the window.

    `phases`, `skirt` [blocks] and `border` [cells] are those of `ScorePyramid`. blocks' is `blocks` rounded up to a
    multiple of 16. Sums of up to 256 points are gathered in 16 bits.
    """
    stride, _, rows, cols = phases.shape
    flat = phases.ravel()
    n_theta, n_points, _ = cells.shape
    chunks = (blocks + LANES - 1) // LANES
    width = chunks * LANES
    level = 0
    while 1 << level < stride:
        level += 1
    bounds = np.zeros((n_theta, blocks, width), dtype=np.int32)
    # All that is not zero lies between the borders; what sees none of it is left out.
    low = border - blocks * stride
    high = ((rows - 2 * skirt) * stride - border, (cols - 2 * skirt - LANES) * stride - border)
    plane, starts = np.empty(blocks * width, dtype=np.uint16), np.empty(256, dtype=np.int64)
    for k in range(n_theta):
        target = bounds[k].ravel()
        for first in range(0, n_points, 256):
            plane[:] = 0
            inside = 0
            for n in range(first, min(first + 256, n_points)):
                row, col = np.int64(cells[k, n, 0]), np.int64(cells[k, n, 1])
                if not (low < row < high[0] and low < col < high[1]):
                    continue
                row0, col0 = (row >> level) + skirt, (col >> level) + skirt
                phase = ((row & (stride - 1)) * stride + (col & (stride - 1))) * rows
                start = (phase + row0) * cols + col0
                if col0 >= 0 and col0 + width <= cols and row0 >= 0 and row0 + blocks <= rows:
                    starts[inside] = start
                    inside += 1
                else:
                    _add_clipped(plane, flat, start, row0, col0, blocks, width, rows, cols)
            for a in range(blocks):
                for chunk in range(0, width, LANES):
                    add_lanes(plane, a * width + chunk, flat, starts, inside, a * cols + chunk)  # pyright: ignore[reportCallIssue]
            for index in range(blocks * width):
                target[index] += plane[index]
    return bounds


@kernel
def child_sums(level, cells, i, j, half, sums):  # pragma: no cover
    """Write the sums over the points at `cells` (N, 2) of `level` (rows', cols') into `sums` (4,).

    The points are moved by (i, j), (i, j + half), (i + half, j) and (i + half, j + half) cells; outside is worth 0.
    """
    rows, cols = level.shape
    flat, down, right = level.ravel(), np.uintp(half * cols), np.uintp(half)
    a, b, c, d = np.int64(0), np.int64(0), np.int64(0), np.int64(0)
    for n in range(len(cells)):
        row, col = np.int64(cells[n, 0]) + i, np.int64(cells[n, 1]) + j
        if 0 <= row < rows - half and 0 <= col < cols - half:
            at = np.uintp(row * cols + col)
            a += flat[at]
            b += flat[at + right]
            c += flat[at + down]
            d += flat[at + down + right]
        elif -half <= row < rows and -half <= col < cols:  # some of the four lie inside
            above, below, left, beyond = row >= 0, row + half < rows, col >= 0, col + half < cols
            a += level[row, col] if above and left else 0
            b += level[row, col + half] if above and beyond else 0
            c += level[row + half, col] if below and left else 0
            d += level[row + half, col + half] if below and beyond else 0
    sums[0], sums[1], sums[2], sums[3] = a, b, c, d


@kernel
def nearest(low, size, centre):  # pragma: no cover
    """Return the square of the distance of `centre` to the nearest of low .. low + size - 1."""
    gap = max(0, low - centre, centre - (low + size - 1))
    return gap * gap


@kernel
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
