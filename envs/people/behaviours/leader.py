"""Who leads the robot: walks the route, pauses, turns round, and has a style.

The numbers of a leader's mind: walking speed [m/s], preferred offset from the route [m], arc length of the end of the
tour [m], whether they wait for a robot that lags, number of the next pause, rest of the present one [s], whether they
turn to the robot in it, whether they wait for it, whether the tour's end was reached. The script: arc length [m],
duration [s], and whether they turn to the robot, of each pause.
"""

import math

import numpy as np
from numpy.typing import NDArray

from ....slam.view_kernel import inner_view_kernel
from ..movement.ground import heading_at
from .making_room import group_offset
from .mind import Around, CompiledWish, Mind, MindKind

Array = NDArray[np.float64]

STYLES = {"steady": (0.75, 1.0), "hurried": (1.0, 1.15), "waits": (0.8, 1.05)}
"""Style -> range of the walking speed [m/s]. Who "waits" stops when the robot lags behind."""
_PAUSE_EVERY = (9.0, 18.0)
_PAUSE_TIME = (1.5, 4.0)
_LAG_STOP, _LAG_GO = 2.6, 1.9
DONE = 8
"""Which number says whether the tour's end was reached."""
_PACE, _SIDE, _STOP_AT, _WAITS, _NEXT, _LEFT, _LOOKS, _WAITING = range(8)


def draw_leader(rng: np.random.Generator, style: str | None, start: float, stop_at: float, side: float = 0.0) -> Mind:
    """Return a leader who starts at arc `start` and ends the tour at `stop_at` [m]; a `style` of None is drawn.

    `side` is the offset from the route that they prefer [m].
    """
    drawn = str(rng.choice(sorted(STYLES)))
    low, high = STYLES[style or drawn]
    pace = float(rng.uniform(low, high))
    pauses = [(0.0, float(rng.uniform(0.5, 1.5)), 0.0)]
    arc = start + rng.uniform(*_PAUSE_EVERY)
    while arc < stop_at - 3.0:
        pauses.append((float(arc), float(rng.uniform(*_PAUSE_TIME)), float(rng.random() < 0.5)))
        arc += rng.uniform(*_PAUSE_EVERY)
    numbers = pace, side, stop_at, float((style or drawn) == "waits")
    return Mind(MindKind.LEADER, numbers, tuple(pauses))


def sided(leader: Mind, side: float) -> Mind:
    """Return the leader with another preferred offset from the route [m]."""
    return leader._replace(numbers=(leader.numbers[_PACE], side, *leader.numbers[_SIDE + 1 :]))


@inner_view_kernel
def leader_wish(person: int, mind: Array, script: Array, around: Around, dt: float) -> CompiledWish:
    """Return the pace, or 0 in a pause, while waiting for the robot, and at the end of the tour."""
    robot, position = around.robot, around.position
    dx, dy = robot[0] - position[person, 0], robot[1] - position[person, 1]
    speed = _speed(mind, script, around.arc[person], math.hypot(dx, dy), dt)
    if mind[_LOOKS] > 0.0:
        face = math.atan2(dy, dx)
    else:
        face = heading_at(around.ways, around.way[person], around.arc[person])
    return speed, group_offset(person, mind[_SIDE], around), 1.0, face, np.nan, np.nan


@inner_view_kernel
def _speed(mind: Array, pauses: Array, arc: float, robot_distance: float, dt: float) -> float:
    if arc >= mind[_STOP_AT]:
        mind[DONE] = 1.0
    if mind[DONE] > 0.0:
        return 0.0
    if mind[_WAITS] > 0.0:
        lag = _LAG_GO if mind[_WAITING] > 0.0 else _LAG_STOP
        mind[_WAITING] = 1.0 if robot_distance > lag else 0.0
    if mind[_LEFT] > 0.0:
        mind[_LEFT] = max(0.0, mind[_LEFT] - dt)
        return 0.0
    mind[_LOOKS] = mind[_WAITING]
    pause = pauses[int(mind[_NEXT])]
    if arc >= pause[0]:
        mind[_NEXT] += 1.0
        mind[_LEFT], mind[_LOOKS] = pause[1], pause[2]
        return 0.0
    return 0.0 if mind[_WAITING] > 0.0 else mind[_PACE]
