"""Kernels that align a scan with a particle's tiles. All lengths are in cells (see `tile_kernels`).

Per point: the nearest mean hit point of the occupied cells in a window, the line through the mean hit points around
it, each with the weight of its hits (a cell behind a wall that noise has hit once says little); the residual is the
distance to that line, or to the point itself where there is no line. A few Gauss-Newton steps with a robust weight, and
with the odometry as a prior, minimise it (Censi 2008 for the metric).

A wall has two faces. The one that the robot sees when it has gone through a door lies where the map knows nothing yet,
beside the one that is drawn: taken for that one, it would put the robot back by the thickness of the wall.
"""

import numpy as np

from ..view_kernel import kernel
from .tile_kernels import MASK, SHIFT, SIDE

_ONE = np.uint64(1)
_ROUNDING = 1e-3  # far more than what means (float32) are off by
_NARROW, _WIDE = 2, 5  # cells; see `draw_lines`
_BEFORE = 2.0  # cells before a line where rays have been if they have seen it from there; walls are thicker
_SHIFT, _MASK, _SIDE = np.uintp(SHIFT), np.uintp(MASK), np.uintp(SIDE)  # unsigned: numba asks of no index if it is < 0


@kernel
def _row_bits(row, first, width, directory, bits):
    """Return the bits of `width` cells of a row from column `first` on; they lie in two tiles at most.

    Without a branch: with one, numba counts references to the arrays in every call, eight times the work.
    """
    tiles = directory[row >> _SHIFT]
    left = np.uint64(bits[np.uintp(tiles[first >> _SHIFT]), row & _MASK])
    right = np.uint64(bits[np.uintp(tiles[(first + width - _ONE) >> _SHIFT]), row & _MASK])
    return ((left | (right << _SIDE)) >> (first & _MASK)) & ((_ONE << width) - _ONE)


@kernel
def _gather(pose, points, stride, directory, means, bits, seen, near, names):
    """Keep `seen`, `near` and `names` of `find_cells` up to date for each `stride`-th of `points`."""
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    rows, cols = directory.shape[0] << SHIFT, directory.shape[1] << SHIFT
    for k in range(0, len(points), stride):
        col = int(np.floor(pose[0] + (cos * points[k, 0] - sin * points[k, 1])))
        row = int(np.floor(pose[1] + (sin * points[k, 0] + cos * points[k, 1])))
        here = (row << 32) | col
        if seen[k, 0] == here:
            continue
        n = 0
        if row >= 1 and col >= 1 and row < rows - 1 and col < cols - 1:
            for r in range(np.uintp(row - 1), np.uintp(row + 2)):
                c = np.uintp(col - 1)
                word = _row_bits(r, c, np.uintp(3), directory, bits)
                while word != 0:
                    if word & _ONE:
                        tile = np.uintp(directory[r >> _SHIFT, c >> _SHIFT])
                        cell = ((r & _MASK) << _SHIFT) | (c & _MASK)
                        near[k, n, 0] = np.float64(c) + means[tile, cell, 0]
                        near[k, n, 1] = np.float64(r) + means[tile, cell, 1]
                        names[k, n] = (np.int64(r) << 32) | np.int64(c)
                        n += 1
                    word >>= _ONE
                    c += _ONE
        seen[k, 0], seen[k, 1] = here, n


@kernel
def find_cells(pose, points, stride, half, directory, means, bits, seen, near, names, squares, cells):
    """Find the occupied cell whose mean hit point is nearest to each `stride`-th of `points`, seen from `pose`.

    Looks at cells at most `half` rows and columns away; first at the closest nine, beyond which all are farther than 1.
    What is among the nine is remembered: a point hardly leaves its cell from step to step.

    Args:
        seen: (n, 3) the cell where each point was, -1 at first; how many of the nine around it are occupied; the cell
            around which nothing is within `half`, -1 where that is not known.
        near, names: (n, 9, 2) the mean hit points of the nine, and (n, 9) their cells.
        squares: (n,) the squared distance; inf if there is none.
        cells: (n,) row and column of the nearest, row << 32 | column; -1 if there is none.
    """
    _gather(pose, points, stride, directory, means, bits, seen, near, names)
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    for k in range(0, len(points), stride):
        x = pose[0] + (cos * points[k, 0] - sin * points[k, 1])
        y = pose[1] + (sin * points[k, 0] + cos * points[k, 1])
        best, found = np.inf, -1
        for i in range(seen[k, 1]):
            dx, dy = near[k, i, 0] - x, near[k, i, 1] - y
            square = dx * dx + dy * dy
            if square < best:
                best, found = square, names[k, i]
        squares[k], cells[k] = best, found
    _look_wide(pose, points, stride, half, directory, means, bits, seen, squares, cells)


@kernel
def _look_wide(pose, points, stride, half, directory, means, bits, seen, squares, cells):
    """Look at the whole window for each `stride`-th of `points` with nothing within 1 cell; see `find_cells`."""
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    rows, cols = directory.shape[0] << SHIFT, directory.shape[1] << SHIFT
    width = np.uintp(2 * half + 1)
    for k in range(0, len(points), stride):
        if squares[k] <= 1.0:
            continue
        x = pose[0] + (cos * points[k, 0] - sin * points[k, 1])
        y = pose[1] + (sin * points[k, 0] + cos * points[k, 1])
        row, col = int(np.floor(y)), int(np.floor(x))
        most, best, found = squares[k], np.inf, -1
        inside = row >= half and col >= half and row < rows - half and col < cols - half
        if inside and seen[k, 2] != seen[k, 0]:
            for r in range(np.uintp(row - half), np.uintp(row + half + 1)):
                apart = max(np.float64(r) - y, y - np.float64(r) - 1.0) - _ROUNDING
                if apart > 0.0 and apart * apart > most:
                    continue  # the whole row is farther
                c = np.uintp(col - half)
                word = _row_bits(r, c, width, directory, bits)
                while word != 0:
                    if word & _ONE:
                        tile = np.uintp(directory[r >> _SHIFT, c >> _SHIFT])
                        cell = ((r & _MASK) << _SHIFT) | (c & _MASK)
                        dx = np.float64(c) + means[tile, cell, 0] - x
                        dy = np.float64(r) + means[tile, cell, 1] - y
                        square = dx * dx + dy * dy
                        if square < best:
                            best, found = square, (np.int64(r) << 32) | np.int64(c)
                            most = min(most, best)
                    word >>= _ONE
                    c += _ONE
            seen[k, 2] = seen[k, 0] if found < 0 else -1
        squares[k], cells[k] = best, found


@kernel
def _is_free(x, y, directory, counts, bits):
    """Return whether rays have crossed the cell at (x, y) and found nothing there."""
    row, col = np.uintp(int(np.floor(y))), np.uintp(int(np.floor(x)))
    tile = np.uintp(directory[row >> _SHIFT, col >> _SHIFT])
    row, col = row & _MASK, col & _MASK
    free = counts[tile, (row << _SHIFT) | col, 1] != 0
    return free and not (bits[tile, row] >> np.uint32(col)) & np.uint32(1)


@kernel
def _moments(row, col, half, directory, counts, means, bits):
    """Return (n, weights, x, y, xx, xy, yy) of the occupied cells at most `half` rows and columns from (row, col).

    How many there are, and sums over all their hits, relative to (row, col).
    """
    n, weights, sx, sy, sxx, sxy, syy = 0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for r in range(np.uintp(row - half), np.uintp(row + half + 1)):
        c = np.uintp(col - half)
        word = _row_bits(r, c, np.uintp(2 * half + 1), directory, bits)
        while word != 0:
            if word & _ONE:
                tile = np.uintp(directory[r >> _SHIFT, c >> _SHIFT])
                cell = ((r & _MASK) << _SHIFT) | (c & _MASK)
                dx = np.float64(np.int64(c) - col) + means[tile, cell, 0]
                dy = np.float64(np.int64(r) - row) + means[tile, cell, 1]
                w = np.float64(counts[tile, cell, 0])
                n += 1
                weights += w
                sx += w * dx
                sy += w * dy
                sxx += w * dx * dx
                sxy += w * dx * dy
                syy += w * dy * dy
            word >>= _ONE
            c += _ONE
    return n, weights, sx, sy, sxx, sxy, syy


@kernel
def draw_lines(cells, stride, straightness, directory, counts, means, bits, known, lines):
    """Draw the lines of all hits in the occupied cells around those of `cells` (n,) that are not `known` (n,) yet.

    Around means within _NARROW rows and columns, or _WIDE where there are fewer than three: beams hit far walls, and
    those that they graze, in few cells, each of which would hold the robot where it was, along the wall, too.

    A line of `lines` (n, 6): 1 (0: there is none), centre x, y, normal x, y; and from where it has been seen: 1 from
    the side where the normal points, -1 from the other one, 0 from both, or nobody knows.
    """
    for k in range(0, len(cells), stride):
        if cells[k] < 0 or known[k] == cells[k]:
            continue
        known[k] = cells[k]
        row, col = cells[k] >> 32, cells[k] & 0xFFFFFFFF
        n, weights, sx, sy, sxx, sxy, syy = _moments(row, col, _NARROW, directory, counts, means, bits)
        if n < 3:
            n, weights, sx, sy, sxx, sxy, syy = _moments(row, col, _WIDE, directory, counts, means, bits)
        lines[k, 0] = 0.0
        if n < 3:
            continue
        sx, sy = sx / weights, sy / weights
        sxx, sxy, syy = sxx / weights - sx * sx, sxy / weights - sx * sy, syy / weights - sy * sy
        root = np.sqrt(0.25 * (sxx - syy) ** 2 + sxy * sxy)
        middle = 0.5 * (sxx + syy)
        if middle - root > straightness * (middle + root):
            continue
        angle = 0.5 * np.arctan2(2.0 * sxy, sxx - syy)
        x, y, nx, ny = col + sx, row + sy, -np.sin(angle), np.cos(angle)
        lines[k, 0], lines[k, 1], lines[k, 2], lines[k, 3], lines[k, 4], lines[k, 5] = 1.0, x, y, nx, ny, 0.0
        if _is_free(x + _BEFORE * nx, y + _BEFORE * ny, directory, counts, bits):
            lines[k, 5] += 1.0
        if _is_free(x - _BEFORE * nx, y - _BEFORE * ny, directory, counts, bits):
            lines[k, 5] -= 1.0


@kernel
def new_memory(n):
    """Return what `accumulate` remembers of n points from step to step: see `find_cells` and `draw_lines`."""
    seen, near, names = np.full((n, 3), -1), np.empty((n, 9, 2)), np.empty((n, 9), dtype=np.int64)
    known, lines = np.full(n, -1), np.empty((n, 6))
    return seen, near, names, np.empty(n), np.empty(n, dtype=np.int64), known, lines


@kernel
def accumulate(pose, points, stride, half, scale, straightness, directory, counts, means, bits, remembered, system):
    """Fill `system` (3, 4), the weighted normal equations [H | g] at `pose`; return (points met, mean loss).

    `remembered` is what `new_memory` returned for these points, and is kept up to date.
    """
    seen, near, names, squares, cells, known, lines = remembered
    find_cells(pose, points, stride, half, directory, means, bits, seen, near, names, squares, cells)
    draw_lines(cells, stride, straightness, directory, counts, means, bits, known, lines)
    return add_up(pose, points, stride, scale, directory, means, squares, cells, lines, system)


@kernel
def add_up(pose, points, stride, scale, directory, means, squares, cells, lines, system):
    """Fill `system` with what each point adds; see `accumulate`."""
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    inverse = 1.0 / (scale * scale)
    met, total, used = 0, 0.0, 0
    h00, h01, h02, h10, h11, h12, h20, h21, h22 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    g0, g1, g2 = 0.0, 0.0, 0.0
    for k in range(0, len(points), stride):
        used += 1
        if cells[k] < 0:
            total += 1.0
            continue
        if lines[k, 0] != 0.0:
            side = lines[k, 3] * (pose[0] - lines[k, 1]) + lines[k, 4] * (pose[1] - lines[k, 2])
            if lines[k, 5] * side < 0.0:  # another face of the wall
                total += 1.0
                continue
        met += 1
        ax = cos * points[k, 0] - sin * points[k, 1]
        ay = sin * points[k, 0] + cos * points[k, 1]
        x, y = pose[0] + ax, pose[1] + ay
        if lines[k, 0] != 0.0:
            nx, ny = lines[k, 3], lines[k, 4]
            turn = ny * ax - nx * ay
            r = nx * (x - lines[k, 1]) + ny * (y - lines[k, 2])
            e = r * r * inverse
            w = 1.0 / (1.0 + e) ** 2
            w0, w1, w2 = w * nx, w * ny, w * turn
            h00, h01, h02, g0 = h00 + w0 * nx, h01 + w0 * ny, h02 + w0 * turn, g0 + w0 * r
            h10, h11, h12, g1 = h10 + w1 * nx, h11 + w1 * ny, h12 + w1 * turn, g1 + w1 * r
            h20, h21, h22, g2 = h20 + w2 * nx, h21 + w2 * ny, h22 + w2 * turn, g2 + w2 * r
        else:
            row, col = np.uintp(cells[k] >> 32), np.uintp(cells[k] & 0xFFFFFFFF)
            tile = np.uintp(directory[row >> _SHIFT, col >> _SHIFT])
            cell = ((row & _MASK) << _SHIFT) | (col & _MASK)
            dx, dy = x - np.float64(col) - means[tile, cell, 0], y - np.float64(row) - means[tile, cell, 1]
            e = squares[k] * inverse
            w = 1.0 / (1.0 + e) ** 2
            wx, wy = w * ax, w * -ay
            h00, h02, h20, g0 = h00 + w, h02 + wy, h20 + wy, g0 + w * dx
            h11, h12, h21, g1 = h11 + w, h12 + wx, h21 + wx, g1 + w * dy
            h22, g2 = h22 + wy * -ay + wx * ax, g2 + wy * dx + wx * dy
        total += e / (1.0 + e)
    system[0, 0], system[0, 1], system[0, 2], system[0, 3] = h00, h01, h02, g0
    system[1, 0], system[1, 1], system[1, 2], system[1, 3] = h10, h11, h12, g1
    system[2, 0], system[2, 1], system[2, 2], system[2, 3] = h20, h21, h22, g2
    return met, total / max(used, 1)


@kernel
def solve(system, step):
    """Write the solution of H step = -g into `step` (3,) by Cholesky; return False where H is not positive."""
    l00 = system[0, 0]
    if l00 <= 0.0:
        return False
    l00 = np.sqrt(l00)
    l10, l20 = system[1, 0] / l00, system[2, 0] / l00
    l11 = system[1, 1] - l10 * l10
    if l11 <= 0.0:
        return False
    l11 = np.sqrt(l11)
    l21 = (system[2, 1] - l20 * l10) / l11
    l22 = system[2, 2] - l20 * l20 - l21 * l21
    if l22 <= 0.0:
        return False
    l22 = np.sqrt(l22)
    y0 = -system[0, 3] / l00
    y1 = (-system[1, 3] - l10 * y0) / l11
    y2 = (-system[2, 3] - l20 * y0 - l21 * y1) / l22
    step[2] = y2 / l22
    step[1] = (y1 - l21 * step[2]) / l11
    step[0] = (y0 - l10 * step[1] - l20 * step[2]) / l00
    return True


@kernel
def match(
    pose, prior, prior_information, points, stages, beams, sigma, straightness, directory, counts, means, bits, system
):
    """Move `pose` (3,) to the best alignment; leave the information matrix in `system`[:, :3]; return (met, loss)."""
    step = np.zeros(3)
    remembered = new_memory(len(points))
    for s in range(len(stages)):
        half, stride, scale = int(stages[s, 0]), int(stages[s, 1]), stages[s, 3]
        remembered[0][:, 2] = -1  # another window
        for _ in range(int(stages[s, 2])):
            met, loss = accumulate(
                pose, points, stride, half, scale, straightness, directory, counts, means, bits, remembered, system
            )
            _weigh(system, met, beams, sigma)
            _add_prior(system, pose, prior, prior_information)
            if not solve(system, step):
                break
            pose += step
            if step[0] * step[0] + step[1] * step[1] < 1e-4 and abs(step[2]) < 1e-4:
                break
    half, scale = int(stages[-1, 0]), stages[-1, 3]
    met, loss = accumulate(
        pose, points, 1, half, scale, straightness, directory, counts, means, bits, remembered, system
    )
    _weigh(system, met, beams, sigma)
    _add_prior(system, pose, prior, prior_information)
    return met, loss


@kernel
def _weigh(system, met, beams, sigma):
    """Scale to a standard deviation of `sigma`, of `beams` independent points at most."""
    system *= min(1.0, beams / max(met, 1)) / (sigma * sigma)


@kernel
def _add_prior(system, pose, prior, information):
    for a in range(3):
        for b in range(3):
            system[a, b] += information[a, b]
            system[a, 3] += information[a, b] * (pose[b] - prior[b])
