"""Who comes towards whom; called for everybody in every step, and so compiled."""

import numpy as np
from numpy.typing import NDArray

from ....slam.view_kernel import view_kernel

Array = NDArray[np.float64]


@view_kernel
def group_comes(person: int, in_group: int, robot: Array, position: Array, velocity: Array, direction: Array) -> bool:
    """Return whether the robot or one of the first `in_group` people is within 2 m before a person, walking to them.

    Args:
        person: Row of the person.
        in_group: How many people the robot's group has.
        robot: (8,) as in `walking.advance_bodies`.
        position: (n, 2) of all people [m].
        velocity: (n, 2) [m/s].
        direction: (n, 2) unit vectors of the wanted walks.
    """
    for other in range(-1, in_group):
        if other < 0:
            x, y, vx, vy = robot[0], robot[1], robot[4], robot[5]
        else:
            x, y, vx, vy = position[other, 0], position[other, 1], velocity[other, 0], velocity[other, 1]
        x -= position[person, 0]
        y -= position[person, 1]
        ahead = x * direction[person, 0] + y * direction[person, 1]
        if ahead > 0.0 and x * x + y * y < 4.0 and vx * x + vy * y < -0.1:
            return True
    return False


@view_kernel
def first_coming(person: int, candidates: NDArray[np.bool_], position: Array, velocity: Array, direction: Array) -> int:
    """Return the first of the `candidates` (n,) within 5 m who comes towards a person on their way; -1 for nobody.

    The others as in `group_comes`.
    """
    dx, dy = direction[person, 0], direction[person, 1]
    for other in range(len(candidates)):
        if not candidates[other] or velocity[other, 0] * dx + velocity[other, 1] * dy >= -0.2:
            continue
        x, y = position[other, 0] - position[person, 0], position[other, 1] - position[person, 1]
        if -0.5 < x * dx + y * dy < 5.0 and abs(y * dx - x * dy) < 1.0:
            return other
    return -1
