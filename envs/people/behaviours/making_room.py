"""How the leader and those who keep the leader company make room for whom they meet."""

import math

import numpy as np

from ....slam.view_kernel import inner_view_kernel, view_kernel
from ..movement.ground import Ground, row_at, turn_out, within_free
from ..movement.meeting import first_coming
from .mind import Around

_BESIDE = int(Ground.BESIDE)


@inner_view_kernel
def group_offset(person: int, side: float, around: Around) -> float:
    """Return the wanted offset from the route [m] of one of the group around the robot.

    In a bend they stay in the middle, because the robot behind them cuts it; they turn out for whom they meet, away
    from the side on which that person walks.

    Args:
        person: Row of the person.
        side: Offset that it prefers where nothing else matters [m].
        around: What it sees.
    """
    ways, arc = around.ways, around.arc[person]
    if ways.sizes[0] > 0.0:
        return side
    if ways.bends[row_at(ways, 0, arc)]:
        return 0.0
    met = first_met(person, around)
    wanted = side if math.isnan(met) else math.copysign(turn_out(ways), -met)
    return within_free(ways, around.way[person], arc, wanted)


@view_kernel
def first_met(person: int, around: Around) -> float:
    """Return the present offset [m] of the first of those who come towards one of the group; NaN: nobody."""
    a = around
    coming = first_coming(person, a.elsewhere, a.position, a.velocity, a.direction)
    for other in range(a.group, len(a.elsewhere) if coming < 0 else coming):
        comes = not a.elsewhere[other] and (a.sense[other] < 0.0 or a.ground[other] == _BESIDE)
        if comes and -1.0 < a.arc[other] - a.arc[person] < 6.0:
            return float(a.lateral[other])
    return float(a.lateral[coming]) if coming >= 0 else np.nan
