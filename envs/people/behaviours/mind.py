"""What compiled behaviours read and remember: one row of numbers a person, and a script."""

from collections.abc import Sequence
from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..movement.ground import Ways

Array = NDArray[np.float64]

NUMBERS = 9
"""Numbers of a person; each behaviour says in its file what stands where."""


class MindKind(IntEnum):
    """How somebody behaves."""

    LEADER = 0
    COMPANION = 1
    WALKER = 2
    STANDER = 3
    SCRIPTED = 4
    WANDERER = 5


class Mind(NamedTuple):
    """A person's behaviour as the episode begins.

    Attributes:
        kind: How they behave.
        numbers: Up to `NUMBERS` of them, what they remember among them; the rest is 0.
        script: Three numbers of each thing that they do in turn.
    """

    kind: MindKind
    numbers: tuple[float, ...]
    script: tuple[tuple[float, float, float], ...] = ()


class Minds(NamedTuple):
    """The behaviours of n people; kernels read and write it.

    Attributes:
        kind: (n,) `MindKind` of each.
        numbers: (n, NUMBERS).
        script: (n, s, 3); behind the end of each script all is inf.
    """

    kind: NDArray[np.int64]
    numbers: Array
    script: Array


class Around(NamedTuple):
    """What all see alike when they decide; kernels take it as it is.

    Attributes:
        position: (n, 2) bodies, world frame [m].
        velocity: (n, 2) [m/s].
        direction: (n, 2) unit vectors of the wanted walks.
        arc: (n,) way along each one's way [m].
        sense: (n,) +1 along it, -1 against it.
        lateral: (n,) wanted offset from it [m].
        wish: (n,) wanted speed [m/s].
        face: (n,) where to look while standing [rad].
        goal: (n, 2) point to go straight to [m]; NaN: along the way.
        way: (n,) which way each walks on; 0 is the route.
        ground: (n,) `Ground` of each.
        elsewhere: (n,) whether that is `Ground.ELSEWHERE`.
        group: How many, the first ones, walk with the robot.
        robot: (8,) as in `walking.advance_bodies`.
        robot_arc: Its way along the route [m].
        ways: The route and all ways.
    """

    position: Array
    velocity: Array
    direction: Array
    arc: Array
    sense: Array
    lateral: Array
    wish: Array
    face: Array
    goal: Array
    way: NDArray[np.int64]
    ground: NDArray[np.int64]
    elsewhere: NDArray[np.bool_]
    group: int
    robot: Array
    robot_arc: float
    ways: Ways


CompiledWish = tuple[float, float, float, float, float, float]
"""Speed [m/s], offset [m], sense, direction to look in [rad], x and y of the goal [m]; NaN as in `Wish`."""


def minds_of(minds: Sequence[Mind]) -> Minds:
    """Return the behaviours of people as arrays."""
    kind = np.array([mind.kind for mind in minds], dtype=np.int64)
    numbers = np.zeros((len(minds), NUMBERS))
    script = np.full((len(minds), max((len(mind.script) for mind in minds), default=0) + 1, 3), np.inf)
    for row, mind in enumerate(minds):
        numbers[row, : len(mind.numbers)] = mind.numbers
        script[row, : len(mind.script)] = np.reshape(mind.script, (-1, 3))
    return Minds(kind, numbers, script)
