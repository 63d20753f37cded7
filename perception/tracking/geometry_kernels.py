"""Distances, and points that are far from others."""

import numpy as np

from ...slam.view_kernel import inner_kernel, kernel


@kernel
def distance(x, y, u, v):
    """Return the distance between (x, y) and (u, v)."""
    return np.sqrt((x - u) * (x - u) + (y - v) * (y - v))


@kernel
def square_distance(x, y, u, v):
    """Return the squared distance of two places [m^2]."""
    return (x - u) ** 2 + (y - v) ** 2


@kernel
def distances(here, there):
    """Return (n, m) Euclidean distances between positions (n, 2) and (m, 2)."""
    away = np.empty((len(here), len(there)))
    for i in range(len(here)):
        for j in range(len(there)):
            away[i, j] = distance(here[i, 0], here[i, 1], there[j, 0], there[j, 1])
    return away


@inner_kernel
def _humans_near(points, first, end, humans, zeta, near):
    """Write into `near` which of `humans` (h, 2) are no farther than `zeta` from the box of the points; how many."""
    low_x, low_y, high_x, high_y = np.inf, np.inf, -np.inf, -np.inf
    for i in range(first, end):
        low_x, high_x = min(low_x, points[i, 0]), max(high_x, points[i, 0])
        low_y, high_y = min(low_y, points[i, 1]), max(high_y, points[i, 1])
    reach, count = 1.01 * zeta, 0  # whatever the last bits of a distance
    for h in range(len(humans)):
        x, y = humans[h, 0], humans[h, 1]
        if low_x - reach <= x <= high_x + reach and low_y - reach <= y <= high_y + reach:
            near[count] = h
            count += 1
    return count


@kernel
def points_of_things(points, start, end, thing, humans, zeta):
    """Return (j, 2) those of `points` (k, 2) in the clusters `thing` (m,), farther than `zeta` from `humans` (h, 2)."""
    kept, near = np.empty_like(points), np.empty(len(humans), np.int64)
    count = 0
    for c in range(len(start)):
        if not thing[c]:
            continue
        close = _humans_near(points, start[c], end[c], humans, zeta, near)
        for i in range(start[c], end[c]):
            clear = True
            for h in near[:close]:
                if distance(points[i, 0], points[i, 1], humans[h, 0], humans[h, 1]) <= zeta:
                    clear = False
                    break
            if clear:
                kept[count, 0] = points[i, 0]
                kept[count, 1] = points[i, 1]
                count += 1
    return kept[:count]
