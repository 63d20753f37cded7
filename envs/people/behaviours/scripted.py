"""Somebody who follows a script."""

import math
from dataclasses import dataclass

from ...scenes.scene import Errand
from .behaviour import Behaviour, Wish
from .view import PersonView

_ARRIVED, _PASSED = 0.15, 0.35  # how near counts as there: at the last place, at those on the way [m]


@dataclass(kw_only=True)
class Scripted(Behaviour):
    """Goes straight from place to place and waits at each, as an errand says.

    Attributes:
        errand: The script.
        place: Number of the place that they go to, or wait at.
        waited_s: For how long they have waited there [s].
    """

    errand: Errand
    place: int = 0
    waited_s: float = 0.0

    def wish(self, view: PersonView, dt: float) -> Wish:
        """Return the pace towards the place, 0 while they wait, and at the last one."""
        speed = self._speed(view, dt)
        return Wish(speed, face=self.errand.face, goal=self.errand.places[self.place][:2])

    def _speed(self, view: PersonView, dt: float) -> float:
        x, y, wait = self.errand.places[self.place]
        away = math.hypot(x - view.position[0], y - view.position[1])
        last = self.place + 1 == len(self.errand.places)
        if away > (_ARRIVED if last else _PASSED) and self.waited_s == 0.0:
            return min(self.errand.pace, 0.25 + 0.8 * away)
        if self.waited_s < wait:
            self.waited_s += dt
        elif not last:
            self.place, self.waited_s = self.place + 1, 0.0
        return 0.0
