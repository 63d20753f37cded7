"""Somebody who comes to stand still beside the route.

They walk to and fro beside the route until the robot has been near for 3 s, then stand for 25 s, and again. The numbers
of the mind: speed [m/s], offset from the route [m], arc lengths between which they walk [m, m], for how long the robot
was near since they last stood [s], for how long they will still stand [s].
"""

import math

import numpy as np
from numpy.typing import NDArray

from ....slam.view_kernel import inner_view_kernel
from .mind import Around, CompiledWish, Mind, MindKind

_SEES_ROBOT_M, _WALKS_ON_S, _STANDS_S = 6.0, 3.0, 25.0


def stander(*, pace: float, side: float, window: tuple[float, float]) -> Mind:
    """Return somebody who walks at `pace` [m/s] between two arc lengths, `side` to the left of the route [m]."""
    return Mind(MindKind.STANDER, (pace, side, *window))


@inner_view_kernel
def stander_wish(person: int, mind: NDArray[np.float64], around: Around, dt: float) -> CompiledWish:
    """Return the pace, or 0 while they stand."""
    arc = around.arc[person]
    sense = -1.0 if arc > mind[3] else 1.0 if arc < mind[2] else around.sense[person]
    if mind[5] > 0.0:
        mind[5] = max(0.0, mind[5] - dt)
        return 0.0, mind[1], sense, np.nan, np.nan, np.nan
    x, y = around.position[person, 0] - around.robot[0], around.position[person, 1] - around.robot[1]
    mind[4] += dt if math.hypot(x, y) < _SEES_ROBOT_M else 0.0
    if mind[4] > _WALKS_ON_S:
        mind[4], mind[5] = 0.0, _STANDS_S
    return mind[0], mind[1], sense, np.nan, np.nan, np.nan
