"""Everybody decides, one after the other, and begins to do it: one compiled call for all worlds' people."""

import math

import numpy as np
from numpy.typing import NDArray

from ....slam.view_kernel import inner_view_kernel, view_kernel
from .companion import companion_wish
from .leader import leader_wish
from .mind import Around, CompiledWish, MindKind, Minds
from .scripted import scripted_wish
from .stander import stander_wish
from .walker import walker_wish
from .wanderer import wanderer_wish

_SPEED_UP, _SLOW_DOWN = 0.7, 1.0  # how fast a wished speed is taken up and given up [m/s^2]
_SIDESTEP = 0.4  # how fast a wished offset is [m/s]
_LEADER, _COMPANION, _WALKER, _STANDER, _SCRIPTED, _WANDERER = (int(kind) for kind in MindKind)


@view_kernel
def decide(minds: Minds, around: Around, dt: float) -> None:
    """Let the people of `minds`, the first of all, wish something for `dt` seconds, and begin to do it."""
    for person in range(len(minds.kind)):
        begin(person, _wish(person, minds, around, dt), around, dt)


@inner_view_kernel
def _wish(person: int, minds: Minds, around: Around, dt: float) -> CompiledWish:
    kind, mind = minds.kind[person], minds.numbers[person]
    if kind == _LEADER:
        return leader_wish(person, mind, minds.script[person], around, dt)
    if kind == _COMPANION:
        return companion_wish(person, mind, around)
    if kind == _WALKER:
        return walker_wish(person, mind, around)
    if kind == _STANDER:
        return stander_wish(person, mind, around, dt)
    if kind == _SCRIPTED:
        return scripted_wish(person, mind, minds.script[person], around, dt)
    return wanderer_wish(person, mind, around, dt)


@view_kernel
def begin(person: int, wish: CompiledWish, around: Around, dt: float) -> None:
    """Take up what somebody wishes, as fast as people do: speed and offset change gradually."""
    speed, offset, sense, face, goal_x, goal_y = wish
    change = min(max(speed - around.wish[person], -_SLOW_DOWN * dt), _SPEED_UP * dt)
    around.wish[person] = max(0.0, around.wish[person] + change)
    around.lateral[person] += min(max(offset - around.lateral[person], -_SIDESTEP * dt), _SIDESTEP * dt)
    around.sense[person], around.face[person] = sense, face
    around.goal[person, 0], around.goal[person, 1] = goal_x, goal_y


@inner_view_kernel
def go_straight(goal: NDArray[np.float64], position: NDArray[np.float64], direction: NDArray[np.float64]) -> None:
    """Point those who have a goal to it; all (n, 2)."""
    for person in range(len(goal)):
        if not math.isnan(goal[person, 0]):
            dx, dy = goal[person, 0] - position[person, 0], goal[person, 1] - position[person, 1]
            away = max(math.sqrt(dx * dx + dy * dy), 1e-6)
            direction[person, 0], direction[person, 1] = dx / away, dy / away
