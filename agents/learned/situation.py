"""What a layer between the network and the wheels knows when it changes a wish."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..scripted.leader_memory import Goal
from .steering import State

Array = NDArray[np.float64]

Wish = tuple[float, float]
"""Speed [m/s] and turn rate [rad/s]."""


class Situation(NamedTuple):
    """One step of one episode, in the robot frame of now.

    Attributes:
        commanded: What the steering commands now.
        goal: Where the leader is taken to be.
        search_turn: Turn rate at which a lost leader is looked for [rad/s].
        trail: (k, 2) the leader's trail from here on [m].
        things: (n, 2) what must not be touched [m].
        people: (m, 6) bystanders, as in the observation.
        room_behind: Asks how far back the ground is known to be free [m].
    """

    commanded: State
    goal: Goal
    search_turn: float
    trail: Array
    things: Array
    people: Array
    room_behind: Callable[[], float]
