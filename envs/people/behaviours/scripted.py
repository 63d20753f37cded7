"""Somebody who follows a script: goes straight from place to place and waits at each, as an errand says.

The numbers of the mind: walking speed [m/s], direction to look to while standing [rad], number of the place that they
go to or wait at, for how long they have waited there [s]. The script: x, y [m] and time to wait [s] of each place.
"""

import math

import numpy as np
from numpy.typing import NDArray

from ....slam.view_kernel import inner_view_kernel
from ...scenes.scene import Errand
from .mind import Around, CompiledWish, Mind, MindKind

Array = NDArray[np.float64]

_ARRIVED, _PASSED = 0.15, 0.35  # how near counts as there: at the last place, at those on the way [m]


def scripted(errand: Errand) -> Mind:
    """Return somebody who does an errand."""
    return Mind(MindKind.SCRIPTED, (errand.pace, errand.face), errand.places)


@inner_view_kernel
def scripted_wish(person: int, mind: Array, script: Array, around: Around, dt: float) -> CompiledWish:
    """Return the pace towards the place, 0 while they wait, and at the last one."""
    place = script[int(mind[2])]
    speed = _speed(
        mind, script, math.hypot(place[0] - around.position[person, 0], place[1] - around.position[person, 1]), dt
    )
    goal = script[int(mind[2])]
    return speed, 0.0, 1.0, mind[1], goal[0], goal[1]


@inner_view_kernel
def _speed(mind: Array, script: Array, away: float, dt: float) -> float:
    """Return the speed `away` from the present place [m]."""
    place = int(mind[2])
    last = not math.isfinite(script[place + 1, 0])
    if away > (_ARRIVED if last else _PASSED) and mind[3] == 0.0:
        return min(mind[0], 0.25 + 0.8 * away)
    if mind[3] < script[place, 2]:
        mind[3] += dt
    elif not last:
        mind[2], mind[3] = mind[2] + 1.0, 0.0
    return 0.0
