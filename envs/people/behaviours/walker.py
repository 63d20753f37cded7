"""Somebody who walks on the robot's route without belonging to its group."""

from dataclasses import dataclass

from .behaviour import Behaviour, Wish
from .view import PersonView

_TURNS_BEFORE_END = 0.9


@dataclass(kw_only=True)
class Walker(Behaviour):
    """Walks to and fro along the route, or round it where it is a lap, keeps right and out of the group's way.

    Attributes:
        pace: Preferred speed [m/s].
        side: Preferred offset from the route where it is a lap [m].
    """

    pace: float
    side: float

    def wish(self, view: PersonView, dt: float) -> Wish:
        """Return the pace, less or more where the group is near."""
        sense = self._sense(view)
        offset = self.side if view.way.lap > 0.0 else view.way.within_free(-sense * view.way.passing)
        return Wish(self._speed(view, sense), offset, sense)

    def _sense(self, view: PersonView) -> float:
        if view.way.lap == 0.0:
            if view.arc > view.way.length - _TURNS_BEFORE_END:
                return -1.0
            if view.arc < _TURNS_BEFORE_END:
                return 1.0
        return view.sense

    def _speed(self, view: PersonView, sense: float) -> float:
        """Return the speed: slower behind the robot, faster before the leader, none before a narrow place."""
        front = max([view.robot_arc, *view.group_arcs])
        if sense < 0.0:
            meets = 0.0 < view.arc - front < 8.0
            return 0.0 if meets and view.way.narrows_before(front) else self.pace
        ahead, behind = view.arc - front, view.robot_arc - view.arc
        if view.way.lap > 0.0:
            ahead, behind = ahead % view.way.lap, behind % view.way.lap
        if 0.0 <= behind < 2.5:
            return 0.3 * self.pace if behind > 1.5 else 0.0
        if 0.0 <= ahead < 2.5 and view.group_arcs:
            return max(self.pace, view.leader_speed + 0.3)
        return self.pace
