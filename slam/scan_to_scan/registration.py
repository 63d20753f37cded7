"""The loop of the iterative matchers (ICP, PL-ICP, MbICP), in numba: correspond, weigh, solve, until at rest."""

import numpy as np

from ..view_kernel import kernel
from .nearest import metric_square, nearest_point

POINT, LINE, METRIC = 0, 1, 2  # what a correspondence measures
_FAR = 1e7  # [m, rad] no step leads farther than any two places are apart


@kernel
def correspond(points, pose, lever, reference, limit, index, square, moved):  # pragma: no cover
    """Move `points` (N, 2) by `pose` and find each one's nearest reference point; returns how many have one.

    Writes index (N,) (-1: none nearer than `limit`), square (N,) of the distance, moved (N, 2). `lever` is MbICP's L
    [m], inf for the Euclidean distance. `reference` = (points, rays, feet, normals, linked, first).
    """
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    count, beside = 0, -1
    for n in range(len(points)):
        x = cos * points[n, 0] - sin * points[n, 1] + pose[0]
        y = sin * points[n, 0] + cos * points[n, 1] + pose[1]
        moved[n, 0], moved[n, 1] = x, y
        k = 1.0 if lever == np.inf else lever * lever / (x * x + y * y + lever * lever)
        index[n], square[n] = nearest_point(x, y, k, reference[0], reference[1], reference[5], limit * limit, beside)
        beside = min(index[n] + 1, len(reference[0]) - 1) if index[n] >= 0 else -1
        count += index[n] >= 0
    return count


@kernel
def trim(index, square, share):  # pragma: no cover
    """Drop (index -1) the farthest of the correspondences so that `share` of them stay."""
    if share >= 1.0:
        return
    matched = square[index >= 0]
    keep = int(np.ceil(share * len(matched)))
    if keep >= len(matched) or keep == 0:
        return
    worst = np.partition(matched, keep - 1)[keep - 1]
    for n in range(len(index)):
        if square[n] > worst:
            index[n] = -1


@kernel
def segment_target(x, y, k, j, points, linked):  # pragma: no cover
    """Return the point nearest to (x, y), in MbICP's metric, on the segments from point j to its neighbours."""
    count = len(points)
    bx, by = points[j, 0], points[j, 1]
    best = metric_square(bx - x, by - y, x, y, k)
    tx, ty = bx, by
    scale = (1.0 - k) / max(x * x + y * y, 1e-12)
    for side in range(2):
        other = (j + 1) % count if side == 0 else j - 1
        if not linked[j if side == 0 else other]:
            continue
        sx, sy = points[other, 0] - bx, points[other, 1] - by
        dx, dy = x - bx, y - by
        cross_s, cross_d = x * sy - y * sx, x * dy - y * dx
        length = sx * sx + sy * sy - scale * cross_s * cross_s
        share = (sx * dx + sy * dy - scale * cross_s * cross_d) / max(length, 1e-12)
        share = min(max(share, 0.0), 1.0)
        px, py = bx + share * sx, by + share * sy
        value = metric_square(px - x, py - y, x, y, k)
        if value < best:
            best, tx, ty = value, px, py
    return tx, ty


@kernel
def normal_equations(kind, pose, lever, reference, scale, index, moved, system):  # pragma: no cover
    """Fill `system` (3, 4) = [H | g] of the step (dx, dy, dtheta) and return (sum of weights, weighted squares).

    `scale` [m] is that of the Geman-McClure weight 1 / (1 + (e / scale)^2)^2.
    """
    system[:] = 0.0
    weights, squares = 0.0, 0.0
    for n in range(len(index)):
        j = index[n]
        if j < 0:
            continue
        x, y = moved[n, 0], moved[n, 1]
        rx, ry = -(y - pose[1]), x - pose[0]
        if kind == LINE:
            nx, ny = reference[3][j, 0], reference[3][j, 1]
            if nx == 0.0 and ny == 0.0:
                continue
            error = nx * (reference[2][j, 0] - x) + ny * (reference[2][j, 1] - y)
            a, b, c = nx * nx, nx * ny, ny * ny
            ex, ey, square = nx * error, ny * error, error * error
        else:
            a, b, c, k = 1.0, 0.0, 1.0, 1.0
            tx, ty = reference[0][j, 0], reference[0][j, 1]
            if kind == METRIC:
                k = lever * lever / (x * x + y * y + lever * lever)
                tx, ty = segment_target(x, y, k, j, reference[0], reference[4])
                share = (1.0 - k) / max(x * x + y * y, 1e-12)
                a, b, c = 1.0 - share * y * y, share * x * y, 1.0 - share * x * x
            dx, dy = tx - x, ty - y
            ex, ey = a * dx + b * dy, b * dx + c * dy
            square = dx * ex + dy * ey
        w = 1.0 / (1.0 + square / (scale * scale))
        w *= w
        mx, my = a * rx + b * ry, b * rx + c * ry
        system[0, 0] += w * a
        system[0, 1] += w * b
        system[1, 1] += w * c
        system[0, 2] += w * mx
        system[1, 2] += w * my
        system[2, 2] += w * (rx * mx + ry * my)
        system[0, 3] += w * ex
        system[1, 3] += w * ey
        system[2, 3] += w * (rx * ex + ry * ey)
        weights += w
        squares += w * square
    return weights, squares


@kernel
def solve_step(system, ridge, step):  # pragma: no cover
    """Solve (H + ridge) step = g by Cholesky; what H leaves open stays put. Returns False if it leads nowhere."""
    a, b, c = system[0, 0] + ridge, system[0, 1], system[0, 2]
    d, e, f = system[1, 1] + ridge, system[1, 2], system[2, 2] + ridge
    if not a > 0.0:
        return False
    l00 = np.sqrt(a)
    l10, l20 = b / l00, c / l00
    l11 = np.sqrt(max(d - l10 * l10, 1e-12))
    l21 = (e - l10 * l20) / l11
    l22 = np.sqrt(max(f - l20 * l20 - l21 * l21, 1e-12))
    z0 = system[0, 3] / l00
    z1 = (system[1, 3] - l10 * z0) / l11
    z2 = (system[2, 3] - l20 * z0 - l21 * z1) / l22
    step[2] = z2 / l22
    step[1] = (z1 - l21 * step[2]) / l11
    step[0] = (z0 - l10 * step[1] - l20 * step[2]) / l00
    return abs(step[0]) + abs(step[1]) + abs(step[2]) < _FAR


@kernel
def register(kind, points, guess, reference, lever, reach, scales, kept, ridge, most, rest):  # pragma: no cover
    """Return (pose, iterations, at rest) of `points` (N, 2) on the reference, from `guess` (3,).

    Args:
        kind: POINT, LINE or METRIC.
        points: (N, 2) of the new scan.
        guess: (3,).
        reference: (points, rays, feet, normals, linked, first) of `Surfaces`.
        lever: MbICP's L [m]; inf for the others.
        reach: (first, last) largest distance of a correspondence [m].
        scales: (first, last, factor) scale of the robust weight [m]; each step multiplies it (and the reach) by factor.
        kept: Share of the correspondences that are kept, nearest first.
        ridge: Damping, times the sum of weights.
        most: Most iterations.
        rest: Steps below (rest [m], rest [rad]) end the loop.
    """
    pose = guess.copy()
    index, square = np.empty(len(points), dtype=np.int32), np.empty(len(points))
    moved, system, step = np.empty((len(points), 2)), np.empty((3, 4)), np.zeros(3)
    limit, scale = reach[0], scales[0]
    for iteration in range(most):
        if correspond(points, pose, lever, reference, limit, index, square, moved) < 3:
            return pose, iteration, False
        trim(index, square, kept)
        weights, _ = normal_equations(kind, pose, lever, reference, scale, index, moved, system)
        if weights < 1e-9 or not solve_step(system, ridge * weights, step):
            return pose, iteration, False
        pose += step
        settled = limit <= reach[1] and scale <= scales[1]
        if settled and max(abs(step[0]), abs(step[1]), abs(step[2])) < rest:
            return pose, iteration + 1, True
        limit, scale = max(limit * scales[2], reach[1]), max(scale * scales[2], scales[1])
    return pose, most, False
