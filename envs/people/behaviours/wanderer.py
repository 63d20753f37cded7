"""Somebody who walks to and fro on a way of their own, rests at its ends, and turns round when held up for too long.

The numbers of the mind: preferred speed [m/s] (where somebody was recorded, that person's speed counts), how far they
keep to the right of the middle of their way [m], how long they stand held up before they turn round [s], how long they
stay at the ends of their way [s], whether they stop for the leader and the robot, for how long they will still rest
[s], for how long they have been held up [s].
"""

import math

import numpy as np
from numpy.typing import NDArray

from ....slam.view_kernel import inner_view_kernel, view_kernel
from ..movement.ground import length_of, row_at, within_free
from ..movement.meeting import group_comes
from .mind import Around, CompiledWish, Mind, MindKind

Array = NDArray[np.float64]

_END = 0.5
_WANTS_TO_WALK, _STANDS = 0.3, 0.15  # who wants more than the one and makes less than the other is held up [m/s]
_PACE, _SIDE, _PATIENCE, _REST, _GIVES_WAY, _RESTS, _HELD_UP = range(7)


def wanderer(*, pace: float, side: float, patience: float, rest: float, gives_way: bool, rests_s: float = 0.0) -> Mind:
    """Return somebody with these numbers, see above, who rests for `rests_s` at first."""
    return Mind(MindKind.WANDERER, (pace, side, patience, rest, float(gives_way), rests_s))


@view_kernel
def wanderer_wish(person: int, mind: Array, around: Around, dt: float) -> CompiledWish:
    """Return the pace, or 0 while they rest or give way."""
    a, ways, way = around, around.ways, around.way[person]
    arc, sense = a.arc[person], a.sense[person]
    if (arc > length_of(ways, way) - _END and sense > 0.0) or (arc < _END and sense < 0.0):
        sense, mind[_RESTS], mind[_HELD_UP] = -sense, mind[_REST], 0.0
    rests = mind[_RESTS] > 0.0
    if rests:
        mind[_RESTS] = max(0.0, mind[_RESTS] - dt)
    elif _loses_patience(mind, a.wish[person], math.hypot(a.velocity[person, 0], a.velocity[person, 1]), dt):
        sense = -sense
    offset = within_free(ways, way, arc, -sense * mind[_SIDE])
    stops = mind[_GIVES_WAY] > 0.0 and group_comes(person, a.group, a.robot, a.position, a.velocity, a.direction)
    if rests or stops:
        return 0.0, offset, sense, np.nan, np.nan, np.nan
    recorded = float(ways.speed[row_at(ways, way, arc)])
    return mind[_PACE] if math.isnan(recorded) else recorded, offset, sense, np.nan, np.nan, np.nan


@inner_view_kernel
def _loses_patience(mind: Array, wanted: float, speed: float, dt: float) -> bool:
    held_up = wanted > _WANTS_TO_WALK and speed < _STANDS
    mind[_HELD_UP] = mind[_HELD_UP] + dt if held_up else max(0.0, mind[_HELD_UP] - dt)
    if mind[_HELD_UP] <= mind[_PATIENCE]:
        return False
    mind[_HELD_UP] = 0.0
    return True
