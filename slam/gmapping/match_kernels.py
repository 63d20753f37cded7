"""Kernels that align a scan with a particle's tiles. All lengths are in cells (see `tile_kernels`).

Per point: the nearest mean hit point of the occupied cells in a window, the line through the mean hit points around
it, each with the weight of its hits (a cell behind a wall that noise has hit once says little); the residual is the
distance to that line, or to the point itself where there is no line. A few Gauss-Newton steps with a robust weight, and
with the odometry as a prior, minimise it (Censi 2008 for the metric).
"""

import numpy as np
from numba import njit

from .tile_kernels import MASK, SHIFT

_ONE = np.uint32(1)


@njit(cache=True, nogil=True)
def nearest(x, y, half, directory, means, bits):
    """Return (squared distance, row, col) of the nearest occupied cell's mean hit point; distance inf if none.

    Looks at cells at most `half` rows and columns away; first at the closest nine, beyond which all are farther than 1.
    """
    best, row, col = _nearest_of(x, y, 1, directory, means, bits)
    if best <= 1.0:
        return best, row, col
    return _nearest_of(x, y, half, directory, means, bits)


@njit(cache=True, nogil=True)
def _nearest_of(x, y, half, directory, means, bits):
    col, row = int(np.floor(x)), int(np.floor(y))
    best, best_row, best_col = np.inf, 0, 0
    if (
        row < half
        or col < half
        or row + half >= directory.shape[0] << SHIFT
        or col + half >= directory.shape[1] << SHIFT
    ):
        return best, best_row, best_col
    for r in range(row - half, row + half + 1):
        c = col - half
        while c <= col + half:
            tile = directory[r >> SHIFT, c >> SHIFT]
            end = min(col + half, c | MASK)
            word = bits[tile, r & MASK] >> np.uint32(c & MASK)
            while word != 0 and c <= end:
                if word & _ONE:
                    cell = ((r & MASK) << SHIFT) | (c & MASK)
                    dx = c + means[tile, cell, 0] - x
                    dy = r + means[tile, cell, 1] - y
                    d2 = dx * dx + dy * dy
                    if d2 < best:
                        best, best_row, best_col = d2, r, c
                word >>= _ONE
                c += 1
            c = end + 1
    return best, best_row, best_col


@njit(cache=True, nogil=True)
def line_around(row, col, half, straightness, directory, counts, means, bits):
    """Return (1 if a line else 0, centre x, y, normal x, y) of all hits in the occupied cells around one of them."""
    n, weights, sx, sy, sxx, sxy, syy = 0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for r in range(row - half, row + half + 1):
        c = col - half
        while c <= col + half:
            tile = directory[r >> SHIFT, c >> SHIFT]
            end = min(col + half, c | MASK)
            word = bits[tile, r & MASK] >> np.uint32(c & MASK)
            while word != 0 and c <= end:
                if word & _ONE:
                    cell = ((r & MASK) << SHIFT) | (c & MASK)
                    dx = c - col + means[tile, cell, 0]
                    dy = r - row + means[tile, cell, 1]
                    w = np.float64(counts[tile, cell, 0])
                    n += 1
                    weights += w
                    sx += w * dx
                    sy += w * dy
                    sxx += w * dx * dx
                    sxy += w * dx * dy
                    syy += w * dy * dy
                word >>= _ONE
                c += 1
            c = end + 1
    if n < 3:
        return 0.0, 0.0, 0.0, 0.0, 0.0
    sx, sy = sx / weights, sy / weights
    sxx, sxy, syy = sxx / weights - sx * sx, sxy / weights - sx * sy, syy / weights - sy * sy
    root = np.sqrt(0.25 * (sxx - syy) ** 2 + sxy * sxy)
    middle = 0.5 * (sxx + syy)
    if middle - root > straightness * (middle + root):
        return 0.0, 0.0, 0.0, 0.0, 0.0
    angle = 0.5 * np.arctan2(2.0 * sxy, sxx - syy)
    return 1.0, col + sx, row + sy, -np.sin(angle), np.cos(angle)


@njit(cache=True, nogil=True)
def accumulate(pose, points, stride, half, scale, straightness, directory, counts, means, bits, known, lines, system):
    """Fill `system` (3, 4), the weighted normal equations [H | g] at `pose`; return (points met, mean loss).

    `known` (n,) is the cell whose line stands in `lines` (n, 5) for each point, -1 at first; both are kept up to date.
    """
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    system[:] = 0.0
    met, total, used = 0, 0.0, 0
    inverse = 1.0 / (scale * scale)
    j = np.zeros(3)
    for k in range(0, len(points), stride):
        ax = cos * points[k, 0] - sin * points[k, 1]
        ay = sin * points[k, 0] + cos * points[k, 1]
        x, y = pose[0] + ax, pose[1] + ay
        used += 1
        d2, row, col = nearest(x, y, half, directory, means, bits)
        if d2 == np.inf:
            total += 1.0
            continue
        met += 1
        cell = (row << 32) | col
        if known[k] != cell:
            known[k] = cell
            lines[k] = line_around(row, col, 2, straightness, directory, counts, means, bits)
        is_line, cx, cy, nx, ny = lines[k]
        if is_line != 0.0:
            r = nx * (x - cx) + ny * (y - cy)
            e = r * r * inverse
            w = 1.0 / (1.0 + e) ** 2
            j[0], j[1], j[2] = nx, ny, ny * ax - nx * ay
            _add(system, j, w, r)
        else:
            tile = directory[row >> SHIFT, col >> SHIFT]
            cell = ((row & MASK) << SHIFT) | (col & MASK)
            dx = x - col - means[tile, cell, 0]
            dy = y - row - means[tile, cell, 1]
            e = d2 * inverse
            w = 1.0 / (1.0 + e) ** 2
            j[0], j[1], j[2] = 1.0, 0.0, -ay
            _add(system, j, w, dx)
            j[0], j[1], j[2] = 0.0, 1.0, ax
            _add(system, j, w, dy)
        total += e / (1.0 + e)
    return met, total / max(used, 1)


@njit(cache=True, nogil=True)
def _add(system, j, w, r):
    for a in range(3):
        wj = w * j[a]
        for b in range(3):
            system[a, b] += wj * j[b]
        system[a, 3] += wj * r


@njit(cache=True, nogil=True)
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


@njit(cache=True, nogil=True)
def match(
    pose, prior, prior_information, points, stages, beams, sigma, straightness, directory, counts, means, bits, system
):
    """Move `pose` (3,) to the best alignment; leave the information matrix in `system`[:, :3]; return (met, loss)."""
    step = np.zeros(3)
    known, lines = np.full(len(points), -1), np.zeros((len(points), 5))
    for s in range(len(stages)):
        half, stride, scale = int(stages[s, 0]), int(stages[s, 1]), stages[s, 3]
        for _ in range(int(stages[s, 2])):
            met, loss = accumulate(
                pose, points, stride, half, scale, straightness, directory, counts, means, bits, known, lines, system
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
        pose, points, 1, half, scale, straightness, directory, counts, means, bits, known, lines, system
    )
    _weigh(system, met, beams, sigma)
    _add_prior(system, pose, prior, prior_information)
    return met, loss


@njit(cache=True, nogil=True)
def _weigh(system, met, beams, sigma):
    """Scale to a standard deviation of `sigma`, of `beams` independent points at most."""
    system *= min(1.0, beams / max(met, 1)) / (sigma * sigma)


@njit(cache=True, nogil=True)
def _add_prior(system, pose, prior, information):
    for a in range(3):
        for b in range(3):
            system[a, b] += information[a, b]
            system[a, 3] += information[a, b] * (pose[b] - prior[b])


@njit(cache=True, nogil=True)
def match_particles(
    start,
    stop,
    poses,
    priors,
    informations,
    points,
    stages,
    beams,
    sigma,
    straightness,
    directory,
    counts,
    means,
    bits,
    systems,
    losses,
):
    """Match particles start..stop; see `match`."""
    for p in range(start, stop):
        _, loss = match(
            poses[p],
            priors[p],
            informations[p],
            points,
            stages,
            beams,
            sigma,
            straightness,
            directory[p],
            counts,
            means,
            bits,
            systems[p],
        )
        losses[p] = loss
