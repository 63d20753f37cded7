"""Somebody who walks on the robot's route without belonging to its group.

They walk to and fro along the route, or round it where it is a lap, keep right and out of the group's way. The numbers
of the mind: preferred speed [m/s], preferred offset from the route where it is a lap [m],
whether they do not see the group.
"""

import numpy as np
from numpy.typing import NDArray

from ....slam.view_kernel import inner_view_kernel
from ..movement.ground import length_of, narrows_before, passing, within_free
from .mind import Around, CompiledWish, Mind, MindKind

_TURNS_BEFORE_END = 0.9


def walker(*, pace: float, side: float, heedless: bool = False) -> Mind:
    """Return somebody who walks at `pace` [m/s], and `side` to the left of a lap [m]; `heedless` of the group."""
    return Mind(MindKind.WALKER, (pace, side, float(heedless)))


@inner_view_kernel
def walker_wish(person: int, mind: NDArray[np.float64], around: Around) -> CompiledWish:
    """Return the pace, less or more where the group is near."""
    ways, way, arc, sense = around.ways, around.way[person], around.arc[person], around.sense[person]
    lap = ways.sizes[0]
    if lap == 0.0:
        if arc > length_of(ways, way) - _TURNS_BEFORE_END:
            sense = -1.0
        elif arc < _TURNS_BEFORE_END:
            sense = 1.0
    offset = mind[1] if lap > 0.0 else within_free(ways, way, arc, -sense * passing(ways))
    speed = mind[0] if mind[2] > 0.0 else _speed(mind[0], arc, sense, around)
    return speed, offset, sense, np.nan, np.nan, np.nan


@inner_view_kernel
def _speed(pace: float, arc: float, sense: float, around: Around) -> float:
    """Return the speed: slower behind the robot, faster before the leader, none before a narrow place."""
    front, lap = around.robot_arc, around.ways.sizes[0]
    for other in range(around.group):
        front = max(front, around.arc[other])
    if sense < 0.0:
        return 0.0 if 0.0 < arc - front < 8.0 and narrows_before(around.ways, arc, front) else pace
    ahead, behind = arc - front, around.robot_arc - arc
    if lap > 0.0:
        ahead, behind = ahead % lap, behind % lap
    if 0.0 <= behind < 2.5:
        return 0.3 * pace if behind > 1.5 else 0.0
    if 0.0 <= ahead < 2.5 and around.group > 0:
        return max(pace, around.wish[0] + 0.3)
    return pace
