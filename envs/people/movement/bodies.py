"""Where n people are and how they move at the moment: arrays that compiled kernels write to."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Start(NamedTuple):
    """Where somebody begins, standing on both feet.

    Attributes:
        x: Of the body [m].
        y: Of the body [m].
        heading: Direction they look in [rad].
        arc: Way along their path [m].
        sense: +1 to walk along the path, -1 against it.
        offset: Offset from the path, left of its direction positive [m].
    """

    x: float
    y: float
    heading: float
    arc: float = 0.0
    sense: float = 1.0
    offset: float = 0.0


class Bodies(NamedTuple):
    """All that changes about the bodies of n people and about what they last wished; kernels take it as it is.

    Attributes:
        position: (n, 2) bodies, world frame [m].
        velocity: (n, 2) [m/s].
        heading: (n,) [rad].
        feet: (n, 2, 2) left and right foot on the floor [m].
        origin: (n, 2) where the swing foot lifted off [m].
        lift: (n, 2) heights of the feet [m].
        phase: (n,) of the present step.
        swing: (n,) foot of the present step, -1 while both stand.
        legs: (n, 2, 2) where the shins meet the laser's plane [m].
        arc: (n,) way along the path [m].
        sense: (n,) +1 along the path, -1 against it.
        lateral: (n,) present wanted offset from the path [m].
        wish: (n,) present wanted speed [m/s].
        face: (n,) where to look while standing [rad]; NaN: anywhere.
        goal: (n, 2) point to go straight to [m]; NaN: along the path.
        direction: (n, 2) unit vectors of the wanted walks.
    """

    position: Array
    velocity: Array
    heading: Array
    feet: Array
    origin: Array
    lift: Array
    phase: Array
    swing: NDArray[np.int64]
    legs: Array
    arc: Array
    sense: Array
    lateral: Array
    wish: Array
    face: Array
    goal: Array
    direction: Array


def standing_bodies(starts: Sequence[Start], stance_half_width: Array) -> Bodies:
    """Return bodies that stand on both feet where they begin.

    Args:
        starts: Where each of the n people begins.
        stance_half_width: (n,) half of the distance between the tracks of their feet [m].
    """
    count = len(starts)
    rows = np.array(starts, dtype=np.float64).reshape(-1, len(Start._fields))
    position, heading = rows[:, :2].copy(), rows[:, 2].copy()
    left = stance_half_width[:, None] * np.stack((-np.sin(heading), np.cos(heading)), axis=-1)
    return Bodies(
        position=position,
        velocity=np.zeros((count, 2)),
        heading=heading,
        feet=np.stack((position + left, position - left), axis=1),
        origin=np.zeros((count, 2)),
        lift=np.zeros((count, 2)),
        phase=np.zeros(count),
        swing=np.full(count, -1, dtype=np.int64),
        legs=np.zeros((count, 2, 2)),
        arc=rows[:, 3].copy(),
        sense=rows[:, 4].copy(),
        lateral=rows[:, 5].copy(),
        wish=np.zeros(count),
        face=np.full(count, np.nan),
        goal=np.full((count, 2), np.nan),
        direction=np.zeros((count, 2)),
    )
