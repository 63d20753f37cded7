"""Somebody who walks to and fro on a way of their own."""

import math
from dataclasses import dataclass

from .behaviour import Behaviour, Wish
from .view import PersonView

_END = 0.5
_WANTS_TO_WALK, _STANDS = 0.3, 0.15  # who wants more than the one and makes less than the other is held up [m/s]


@dataclass(kw_only=True)
class Wanderer(Behaviour):
    """Walks to and fro on a way, rests at its ends, and turns round when held up for too long.

    Attributes:
        pace: Preferred speed [m/s]; where somebody was recorded, that person's speed counts.
        side: How far they keep to the right of the middle of their way [m].
        patience: How long they stand held up before they turn round [s].
        rest: How long they stay at the ends of their way [s].
        gives_way: Whether they stop for the leader and the robot.
        rests_s: For how long they will still rest [s].
        held_up_s: For how long they have been held up [s].
    """

    pace: float
    side: float
    patience: float
    rest: float
    gives_way: bool
    rests_s: float = 0.0
    held_up_s: float = 0.0

    def wish(self, view: PersonView, dt: float) -> Wish:
        """Return the pace, or 0 while they rest or give way."""
        sense = view.sense
        if (view.arc > view.way.length - _END and sense > 0.0) or (view.arc < _END and sense < 0.0):
            sense, self.rests_s, self.held_up_s = -sense, self.rest, 0.0
        rests = self.rests_s > 0.0
        if rests:
            self.rests_s = max(0.0, self.rests_s - dt)
        elif self._loses_patience(view, dt):
            sense = -sense
        offset = view.way.within_free(-sense * self.side)
        if rests or (self.gives_way and view.group_comes()):
            return Wish(0.0, offset, sense)
        recorded = view.way.recorded_speed
        return Wish(self.pace if math.isnan(recorded) else recorded, offset, sense)

    def _loses_patience(self, view: PersonView, dt: float) -> bool:
        held_up = view.speed > _WANTS_TO_WALK and math.hypot(*view.velocity.tolist()) < _STANDS
        self.held_up_s = self.held_up_s + dt if held_up else max(0.0, self.held_up_s - dt)
        if self.held_up_s <= self.patience:
            return False
        self.held_up_s = 0.0
        return True
