"""Where people will be: each walks on as it does, along walls and not through them."""

import numpy as np
from numpy.typing import NDArray

from ...slam.view_kernel import kernel
from .fields import value_at

Array = NDArray[np.float64]


@kernel
def walked_on(people: Array, distances: Array, half: float, cell: float, steps: int, dt: float, room: float) -> Array:
    """Return (k, steps, 2) where people are after `dt`, 2 `dt`, ... [m].

    Args:
        people: (k, 4) x, y, vx, vy, robot frame, over ground [m, m/s].
        distances: Field of the distances from what stands [m].
        half: It reaches so far from the robot [m].
        cell: Side of its cells [m].
        steps: How many.
        dt: Step [s].
        room: They keep so far from what stands, centre to surface [m], if they are not nearer already.
    """
    where = np.zeros((len(people), steps, 2))
    for i in range(len(people)):
        x, y = people[i, 0], people[i, 1]
        for k in range(steps):
            nx, ny = x + people[i, 2] * dt, y + people[i, 3] * dt
            gap = value_at(distances, nx, ny, half, cell)
            if gap < room and gap < value_at(distances, x, y, half, cell):
                gx = value_at(distances, nx + cell, ny, half, cell) - value_at(distances, nx - cell, ny, half, cell)
                gy = value_at(distances, nx, ny + cell, half, cell) - value_at(distances, nx, ny - cell, half, cell)
                steep = np.sqrt(gx * gx + gy * gy)
                if steep > 1e-6:
                    into = min(((nx - x) * gx + (ny - y) * gy) / steep, 0.0)
                    nx, ny = nx - into * gx / steep, ny - into * gy / steep
                else:
                    nx, ny = x, y
            x, y = nx, ny
            where[i, k, 0], where[i, k, 1] = x, y
    return where
