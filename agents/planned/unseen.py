"""What the robot's own map does not show yet, and how much of it would come into sight from where.

A next-best-view gain (Gonzalez-Banos and Latombe 2002), as a field around the robot: of each place, the area of unknown
floor that a laser there would look at, and that is in sight neither from the robot nor from where it will be anyway.
What it looks at already and is still unknown will not be known from elsewhere either.
"""

import numpy as np
from numpy.typing import NDArray

from ...envs.task.interface import OwnMap
from ...slam.view_kernel import kernel

Array = NDArray[np.float64]
States = NDArray[np.int8]

PLACES_M = 0.4
"""Distance between two places of the field."""
HALF_M = 2.4
"""The field reaches so far from the robot, ahead, back and aside: about two seconds' way."""
SIGHT_M = 5.0
"""What is farther away is not counted: there beams lie too far apart to show a floor."""
BEYOND_M = 1.0
"""Of a ray through unknown ground so much counts: what is behind, nobody can say."""
CELL_M = 0.1
UNKNOWN, FREE, WALL = 0, 1, 2
_RAYS, _RAYS_HERE = 90, 720


def unseen_field(own: OwnMap, way: Array) -> Array:
    """Return (n, n) the area [m2] of unknown floor in sight from places around the robot, and not from its way.

    Args:
        own: The robot's map, and where it is in it.
        way: (m, 2) places where it will be anyway, robot frame [m].

    Places lie `PLACES_M` apart, the first `HALF_M` behind and to the right, turned with the robot, as cells of
    `fields.value_at`; 0 where nothing is known or something stands, and everywhere for a robot that is nowhere yet.
    """
    known, count = own.map, round(2.0 * HALF_M / PLACES_M)
    if not np.isfinite(own.pose).all():
        return np.zeros((count, count))
    half = np.ceil((HALF_M * np.sqrt(2.0) + SIGHT_M) / CELL_M) * CELL_M
    corner = own.pose[:2] - half
    states = coarse_states(
        known.probability, known.free_threshold, known.occupied_threshold, known.resolution,
        np.asarray(known.origin), corner, round(2.0 * half / CELL_M),
    )  # fmt: skip
    middles = PLACES_M * (np.arange(count) + 0.5) - HALF_M
    ahead, left = np.meshgrid(middles, middles, indexing="ij")
    cos, sin = np.cos(own.pose[2]), np.sin(own.pose[2])

    def placed(x: NDArray[np.floating], y: NDArray[np.floating]) -> Array:
        return (half + np.stack((cos * x - sin * y, sin * x + cos * y), axis=-1)) / CELL_M

    anyway = placed(*np.vstack((np.zeros(2), way)).T)
    return newly_in_sight(states, placed(ahead, left), anyway)


@kernel
def coarse_states(
    probability: NDArray[np.float32],
    free: float,
    occupied: float,
    resolution: float,
    origin: Array,
    corner: Array,
    count: int,
) -> States:
    """Return (count, count) x by y of cells of `CELL_M`: `WALL` where any of the map's is, `FREE` where any is free.

    Args:
        probability: (rows, cols) of the map, NaN where nothing is known.
        free: Below it a cell is free.
        occupied: Above it there is something.
        resolution: Side of the map's cells [m].
        origin: (2,) corner of its first [m].
        corner: (2,) corner of the first cell that is returned, map frame [m].
        count: How many to each side.
    """
    states = np.full((count, count), UNKNOWN, dtype=np.int8)
    rows, cols = probability.shape
    every = max(1, round(CELL_M / resolution))
    for i in range(count):
        first_col = int(np.floor((corner[0] + (i + 0.5) * CELL_M - origin[0]) / resolution - 0.5 * every + 0.5))
        for j in range(count):
            first_row = int(np.floor((corner[1] + (j + 0.5) * CELL_M - origin[1]) / resolution - 0.5 * every + 0.5))
            for row in range(max(first_row, 0), min(first_row + every, rows)):
                for col in range(max(first_col, 0), min(first_col + every, cols)):
                    value = probability[row, col]
                    if value > occupied:
                        states[i, j] = WALL
                    elif value < free and states[i, j] == UNKNOWN:
                        states[i, j] = FREE
    return states


@kernel
def newly_in_sight(states: States, places: Array, anyway: Array) -> Array:
    """Return (n, n) unknown areas [m2] in sight from `places` (n, n, 2) and not from any of `anyway` (m, 2) [cells]."""
    n = len(places)
    gains = np.zeros((n, n))
    looked = np.zeros(states.shape, dtype=np.bool_)
    for k in range(len(anyway)):
        if 0 <= anyway[k, 0] < len(states) and 0 <= anyway[k, 1] < len(states):
            look(states, anyway[k, 0], anyway[k, 1], looked, _RAYS_HERE, True)
    for a in range(n):
        for b in range(n):
            x, y = places[a, b, 0], places[a, b, 1]
            if states[int(x), int(y)] == FREE:
                gains[a, b] = look(states, x, y, looked, _RAYS, False)
    return gains


@kernel
def look(states: States, x: float, y: float, looked: NDArray[np.bool_], rays: int, marks: bool) -> float:
    """Look around from x, y [cells] along `rays`; return the unknown area [m2] that is not `looked` at, or mark it."""
    count = len(states)
    area, most = 0.0, int(BEYOND_M / CELL_M)
    for k in range(rays):
        angle = 2.0 * np.pi * k / rays
        step_x, step_y = np.cos(angle), np.sin(angle)
        through = 0
        for step in range(1, int(SIGHT_M / CELL_M)):
            i, j = int(x + step * step_x), int(y + step * step_y)
            if not (0 <= i < count and 0 <= j < count) or states[i, j] == WALL:
                break
            if states[i, j] == UNKNOWN:
                through += 1
                if through > most:
                    break
                if marks:
                    looked[i, j] = True
                elif not looked[i, j]:
                    area += step
    return area * CELL_M * CELL_M * 2.0 * np.pi / rays
