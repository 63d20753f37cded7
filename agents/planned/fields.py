"""Two fields around the robot: how far the next thing is, and how far it is to walk from everywhere to a place."""

import numpy as np
from numpy.typing import NDArray

from ...slam.view_kernel import kernel
from ..scripted.grid_field import way_field

Array = NDArray[np.float64]

HALF_M = 4.0
"""Fields reach so far from the robot, ahead, back and aside [m]."""
CELL_M, WAY_CELL_M = 0.05, 0.1
"""Sides of the cells of the field of distances and of that of ways [m]."""
FAR_M = 0.7
"""Distances from things are told up to this [m]: half of a robot's diagonal and some room."""
NO_WAY_M = 30.0
"""Length of the way from where none is known [m]."""


@kernel
def distance_field(points: Array, half: float, cell: float, far: float) -> Array:
    """Return (n, n) the distance from the middle of each cell to the nearest of `points` (m, 2), at most `far` [m]."""
    n, reach = round(2.0 * half / cell), int(far / cell)
    square = np.full((n, n), far * far)
    for k in range(len(points)):
        x, y = (points[k, 0] + half) / cell - 0.5, (points[k, 1] + half) / cell - 0.5
        row, col = int(np.round(x)), int(np.round(y))
        for i in range(max(row - reach, 0), min(row + reach + 1, n)):
            across = (i - x) * (i - x)
            for j in range(max(col - reach, 0), min(col + reach + 1, n)):
                gap = (across + (j - y) * (j - y)) * cell * cell
                if gap < square[i, j]:
                    square[i, j] = gap
    return np.sqrt(square)


@kernel
def value_at(field: Array, x: float, y: float, half: float, cell: float) -> float:
    """Return the value of a field at a place [m], between the middles of its cells; beyond its edge, that there."""
    n = len(field)
    row = min(max((x + half) / cell - 0.5, 0.0), n - 1.001)
    col = min(max((y + half) / cell - 0.5, 0.0), n - 1.001)
    i, j = int(row), int(col)
    a, b = row - i, col - j
    low = (1.0 - b) * field[i, j] + b * field[i, j + 1]
    return (1.0 - a) * low + a * ((1.0 - b) * field[i + 1, j] + b * field[i + 1, j + 1])


def ways_to(place: Array, distances: Array, half_width: float, narrow: float, near: float) -> Array:
    """Return (n, n) the length of the way from the middle of each cell to `place` [m], at most `NO_WAY_M`.

    Where the robot hardly fits, the way counts as longer; it is barred only where a thing is.

    Args:
        place: (2,) in the robot frame [m].
        distances: `distance_field` of what stands.
        half_width: Of the robot [m].
        near: Nearer to the place than this, narrowness does not matter [m]: who is there need not come nearer.
        narrow: Who comes nearer than this to a thing, centre to surface, goes slowly [m].
    """
    every = round(WAY_CELL_M / CELL_M)
    free = distances[::every, ::every]
    for i, j in np.ndindex(every, every):
        free = np.minimum(free, distances[i::every, j::every])
    cost = 1.0 + 3.0 * np.clip((narrow - free) / max(narrow - half_width, 1e-3), 0.0, 1.0)
    cost[free < half_width] = 40.0
    n = len(cost)
    middles = WAY_CELL_M * (np.arange(n) + 0.5) - HALF_M
    cost[np.hypot(middles[:, None] - place[0], middles - place[1]) < near] = 1.0
    cost[free < CELL_M] = np.inf
    row, col = (min(max(int((value + HALF_M) / WAY_CELL_M), 0), n - 1) for value in place.tolist())
    cost[row, col] = min(cost[row, col], 40.0)
    field, parent = np.empty((n, n)), np.empty((n, n), dtype=np.int32)
    way_field(cost, row, col, field, parent)
    return np.minimum(field * WAY_CELL_M, NO_WAY_M)
