"""How the leader and those who keep the leader company make room for whom they meet."""

import math

from .view import PersonView


def group_offset(view: PersonView, side: float) -> float:
    """Return the wanted offset from the route [m] of one of the group around the robot.

    In a bend they stay in the middle, because the robot behind them cuts it; they turn out for whom they meet, away
    from the side on which that person walks.

    Args:
        view: What the person sees.
        side: Offset that it prefers where nothing else matters [m].
    """
    if view.way.lap > 0.0:
        return side
    if view.way.bends:
        return 0.0
    met = view.first_met()
    wanted = side if met is None else math.copysign(view.way.turn_out, -met)
    return view.way.within_free(wanted)
