"""Somebody who keeps the leader company."""

from dataclasses import dataclass

from .behaviour import Behaviour, Wish
from .making_room import group_offset
from .view import PersonView

_FASTEST = 1.5
_LEFT_BEHIND = 2.5  # who was overtaken by the leader stands until the robot is this far past them [m]


@dataclass(kw_only=True)
class Companion(Behaviour):
    """Walks a little ahead of the leader, and waits to fall in behind the robot when left behind.

    Attributes:
        gap: How far ahead of the leader [m].
        side: Preferred offset from the route [m].
    """

    gap: float
    side: float

    def wish(self, view: PersonView, dt: float) -> Wish:
        """Return the leader's speed, more or less by how far the gap is from the wanted one."""
        offset, ahead = group_offset(view, self.side), view.arc - view.leader_arc
        if ahead < 0.0 and view.arc - view.robot_arc > -_LEFT_BEHIND:
            return Wish(0.0, offset, face=view.face)
        late = self.gap - ahead
        waits = view.leader_speed == 0.0 and late < 0.2
        speed = 0.0 if waits else min(max(view.leader_speed + 0.8 * late, 0.0), _FASTEST)
        return Wish(speed, offset, face=view.way.heading)
