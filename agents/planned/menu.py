"""Plans that are weighed in every step beside those drawn: what the last plan is far from is not missed."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_SPEEDS = (-0.3, 0.0, 0.4, 0.8, 1.2)  # [m/s]
_TURNS = (0.0, -1.5, -0.8, -0.35, 0.35, 0.8, 1.5)  # [rad/s]
_THEN = (-0.8, 0.0, 1.0)
"""Shares of the turn rate with which a plan goes on: as round a post, straight on, further round."""
_TURN_S = 0.8
_ASIDE = (-0.4, 0.4)  # [m/s]


def plans_to_weigh(knots: int, knot_s: float, holonomic: bool) -> Array:
    """Return (n, knots, 3) wishes forward, left [m/s] and turn [rad/s], `knot_s` apart [s].

    A speed, a turn rate for 0.8 s and another one then; for a holonomic robot also sideways.
    """
    early = knot_s * np.arange(knots) < _TURN_S
    plans = []
    for speed in _SPEEDS:
        for turn in _TURNS:
            for then in _THEN if turn else (1.0,):
                plans.append(_plan(np.full(knots, speed), np.zeros(knots), np.where(early, turn, then * turn)))
        for aside in _ASIDE if holonomic else ():
            plans.append(_plan(np.full(knots, speed), np.full(knots, aside), np.zeros(knots)))
    return np.array(plans)


def _plan(forward: Array, left: Array, turn: Array) -> Array:
    return np.stack((forward, left, turn), axis=1)
