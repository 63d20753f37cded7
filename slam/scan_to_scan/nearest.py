"""The nearest point of a reference scan, found along its beams.

A point q at range r can be no nearer to any point on a beam at angle a from it than r sin(a), so the search walks from
q's own bearing to both sides and stops where that bound exceeds the best found: exact, and a few beams long. In the
metric of MbICP (Minguez, Montesano, Lamiraux 2006), which discounts motion across the beam, the bound is
r^2 k sin^2(a) / (cos^2(a) + k sin^2(a)) with k = L^2 / (r^2 + L^2); k = 1 is the Euclidean one.
"""

import numpy as np

from ..view_kernel import kernel

_BINS_PER_RADIAN = 1024 / (2.0 * np.pi)


@kernel
def bin_near(x, y):  # pragma: no cover
    """Return the bin, of 1024 from -pi, of the bearing of (x, y), or one beside it: four times as fast as arctan2."""
    across, along = abs(x), abs(y)
    least, most = min(across, along), max(across, along)
    share = least / most if most > 0.0 else 0.0
    # Within 0.004 rad of the arc tangent; a bin is 0.006.
    angle = share * (0.25 * np.pi + 0.273 * (1.0 - share))
    if along > across:
        angle = 0.5 * np.pi - angle
    if x < 0.0:
        angle = np.pi - angle
    if y < 0.0:
        angle = -angle
    return min(int((angle + np.pi) * _BINS_PER_RADIAN), 1023) if angle == angle else 0


@kernel
def metric_square(dx, dy, x, y, k):  # pragma: no cover
    """Return the square of the distance of (x, y) and (x + dx, y + dy): radial^2 + k across^2."""
    if k >= 1.0:
        return dx * dx + dy * dy
    square = x * x + y * y
    if square < 1e-12:
        return dx * dx + dy * dy
    cross = x * dy - y * dx
    return dx * dx + dy * dy - (1.0 - k) * cross * cross / square


@kernel
def _beam_too_far(dot, cross, range_square, k, square):  # pragma: no cover
    """Whether no point of a beam is nearer than `square`.

    Beyond 90 degrees from q's bearing the nearest point of the beam is its origin.

    Args:
        dot: Of q and the beam's direction.
        cross: Of them.
        range_square: Squared distance of q from the origin.
        k: Of the metric.
        square: The squared distance.
    """
    if dot > 0.0:
        across = k * cross * cross
        return range_square * across > square * (dot * dot + across)
    return range_square > square


@kernel
def nearest_point(x, y, k, points, rays, first, limit, hint=-1):  # pragma: no cover
    """Return (index, squared distance) of the nearest of `points` to (x, y); (-1, limit) if none is below `limit`.

    The answer is the same with any `hint`, an index that may be near: the search is shorter with a good one.
    """
    count = len(points)
    best, square = -1, limit
    if hint >= 0:
        value = metric_square(points[hint, 0] - x, points[hint, 1] - y, x, y, k)
        if value < square:
            best, square = hint, value
    range_square = x * x + y * y
    # A beam too early or too late is as good a start: no side ends before q's bearing is passed.
    start = first[bin_near(x, y)]
    for direction in (1, -1):
        index = start if direction == 1 else start - 1
        for _ in range(count):
            if index >= count:
                index -= count
            elif index < 0:
                index += count
            dot = x * rays[index, 0] + y * rays[index, 1]
            cross = x * rays[index, 1] - y * rays[index, 0]
            if (cross * direction > 0.0 or dot < 0.0) and _beam_too_far(dot, cross, range_square, k, square):
                break
            value = metric_square(points[index, 0] - x, points[index, 1] - y, x, y, k)
            if value < square or (value == square and best >= 0 and index < best):
                best, square = index, value
            index += direction
    return best, square
