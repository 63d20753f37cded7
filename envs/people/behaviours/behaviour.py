"""What a behaviour is: one verb that says, several times a second, what a person wants to do now."""

import math
from abc import ABC, abstractmethod
from typing import NamedTuple

from ....slam.errors import InputError, shown
from .view import PersonView

FASTEST = 3.0
"""Largest speed that somebody can wish [m/s]: a run; people walk at 1.4 m/s."""
WIDEST = 100.0
"""Largest offset from the way that somebody can wish [m]: more than any building here is wide."""


MOST_BEHAVIOURS = 200
"""Most people with behaviours of one's own: the forces between people are as many as their pairs."""


class Wish(NamedTuple):
    """What a person wants to do now. Body, gait and the making room for others follow from it by themselves.

    Attributes:
        speed: Wanted speed, 0 .. 3 [m/s]; 0 stands. It is taken up and given up gradually.
        offset: Wanted offset from the way, left of its direction positive [m].
        sense: +1 along the way, -1 against it.
        face: Direction to look in while standing [rad]; NaN: anywhere.
        goal: Point (x, y) to go straight to, world frame [m]; None: along the way.
    """

    speed: float
    offset: float = 0.0
    sense: float = 1.0
    face: float = math.nan
    goal: tuple[float, float] | None = None


class Behaviour(ABC):
    """How a person behaves. Derive from it, and say in `wish` what the person wants to do now.

    An object of a behaviour belongs to one person. Whatever it remembers between two calls stands in its attributes,
    which are copied, saved and restored with the world; each episode begins with a copy of the object that was given.
    Random numbers come from `view.rng` alone, so that a seed gives the same episode again.

    Attributes:
        start: Pose (x, y, heading) at which the person begins, world frame [m, m, rad]; None for a place on the route
            that is drawn.
    """

    start: tuple[float, float, float] | None = None

    @abstractmethod
    def wish(self, view: PersonView, dt: float) -> Wish:
        """Return what the person wants to do for the next `dt` seconds, given what it sees of itself and others."""


def checked_wish(wish: object, behaviour: Behaviour) -> Wish:
    """Return `wish`, which `behaviour` has returned.

    Raises:
        InputError: If it is no wish, or one that no body can fulfil.
    """
    who = f"`{type(behaviour).__name__}.wish`"
    if not isinstance(wish, Wish):
        raise InputError(f"{who} must return a Wish, got {shown(wish)}")
    if not 0.0 <= wish.speed <= FASTEST or not -WIDEST <= wish.offset <= WIDEST:
        raise InputError(f"{who} must wish a speed within 0 .. {FASTEST} m/s and a finite offset, got {shown(wish)}")
    if wish.sense not in (-1.0, 1.0):
        raise InputError(f"{who} must wish a sense of +1 or -1, got {shown(wish.sense)}")
    if wish.goal is not None and not all(math.isfinite(value) for value in wish.goal):
        raise InputError(f"{who} must wish a finite goal, got {shown(wish.goal)}")
    return wish


def checked_behaviours(given: object) -> tuple[Behaviour, ...]:
    """Return the behaviours of a configuration as a tuple.

    Raises:
        InputError: If they are no list of objects of classes derived from `Behaviour`, or too many.
    """
    behaviours = tuple(given) if isinstance(given, list | tuple) else None
    if behaviours is None or not all(isinstance(each, Behaviour) for each in behaviours):
        raise InputError(f"`behaviours` must be a list of `Behaviour` objects, got {shown(given)}")
    if len(behaviours) > MOST_BEHAVIOURS:
        raise InputError(f"`behaviours` must be at most {MOST_BEHAVIOURS} people, got {len(behaviours)}")
    return behaviours
