"""Which of two poses explains two scans better: surfaces that meet, less surfaces that stand in seen free space."""

import numpy as np

from ..view_kernel import kernel
from .nearest import nearest_point


@kernel
def range_ahead(x, y, points, rays, first):  # pragma: no cover
    """Return the least range [m] of the two returns around the bearing of (x, y); -1 where there is none close by."""
    count = len(points)
    after = first[min(int((np.arctan2(y, x) + np.pi) * (1024 / (2.0 * np.pi))), 1023)] % count
    for _ in range(8):
        if x * rays[after, 1] - y * rays[after, 0] > 0.0:
            break
        after = (after + 1) % count
    return range_between(x, y, after, points, rays)


@kernel
def range_between(x, y, after, points, rays):  # pragma: no cover
    """Return the same, given the index of the first return counter-clockwise of (x, y)."""
    distance = np.sqrt(x * x + y * y)
    least = -1.0
    for index in (after, after - 1):
        cross = x * rays[index, 1] - y * rays[index, 0]
        # Five degrees: beyond that no beam of the reference looked there.
        if abs(cross) < 0.087 * distance and x * rays[index, 0] + y * rays[index, 1] > 0.0:
            found = points[index, 0] * rays[index, 0] + points[index, 1] * rays[index, 1]
            least = found if least < 0.0 else min(least, found)
    return least


@kernel
def turn_of(x, y):  # pragma: no cover
    """Return a number from -2 to 2 that grows with the bearing of (x, y) from -pi to pi."""
    share = y / (abs(x) + abs(y) + 1e-300)
    if x >= 0.0:
        return share
    return 2.0 - share if y >= 0.0 else -2.0 - share


@kernel
def agreement(points, pose, reference, rays, feet, normals, first, sigma, margin):  # pragma: no cover
    """Return (hits, contradictions, most) of `points` (N, 2), at `pose`, with a reference scan's surfaces.

    Each point counts its range [m], `most` is the sum of those: beams stand close on what is near, so that a wall
    beside the laser, alike along a whole corridor, would outvote all that stands ahead. A hit counts
    exp(-e^2 / 2 sigma^2) of it, e the distance from the line of the nearest return [m]. A point that lies nearer than
    the reference's return in that direction stands where the reference saw free space: it contradicts by how much
    nearer it is [m], at most 1, and by 1 more where that exceeds `margin` [m].
    """
    hits, contradictions, most = 0.0, 0.0, 0.0
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    beside = -1
    for n in range(len(points)):
        weight = np.sqrt(points[n, 0] ** 2 + points[n, 1] ** 2)
        most += weight
        x = cos * points[n, 0] - sin * points[n, 1] + pose[0]
        y = sin * points[n, 0] + cos * points[n, 1] + pose[1]
        j, square = nearest_point(x, y, 1.0, reference, rays, first, 0.09, beside)
        beside = min(j + 1, len(reference) - 1) if j >= 0 else -1
        if j >= 0:
            if normals[j, 0] != 0.0 or normals[j, 1] != 0.0:
                error = normals[j, 0] * (feet[j, 0] - x) + normals[j, 1] * (feet[j, 1] - y)
                square = error * error
            hits += weight * np.exp(-0.5 * square / (sigma * sigma))
        gap = range_ahead(x, y, reference, rays, first) - np.sqrt(x * x + y * y)
        if gap > 0.0:
            contradictions += weight * (min(gap, 1.0) + (1.0 if gap > margin else 0.0))
    return hits, contradictions, most


@kernel
def mark_unseen(points, rays, x0, y0, cell, margin, worth, values):  # pragma: no cover
    """Raise the cells of `values` (rows, cols) uint8 that the reference did not see to be free to `worth`.

    Free is what lies nearer than the reference's return in that direction by more than `margin` [m]. Along a row of
    cells the bearing only grows or only falls, so the beam ahead is that of the last cell or close to it.
    """
    rows, cols = values.shape
    count = len(rays)
    turns, after = np.empty(count), 0
    for m in range(count):
        turns[m] = turn_of(rays[m, 0], rays[m, 1])
    for row in range(rows):
        y = y0 + (row + 0.5) * cell
        for col in range(cols):
            if values[row, col] >= worth:
                continue
            x = x0 + (col + 0.5) * cell
            turn = turn_of(x, y)
            while after < count and turns[after] <= turn:
                after += 1
            while after > 0 and turns[after - 1] > turn:
                after -= 1
            if range_between(x, y, after % count, points, rays) <= np.sqrt(x * x + y * y) + margin:
                values[row, col] = worth
