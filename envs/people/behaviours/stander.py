"""Somebody who comes to stand still beside the route."""

from dataclasses import dataclass

from .behaviour import Behaviour, Wish
from .view import PersonView

_SEES_ROBOT_M, _WALKS_ON_S, _STANDS_S = 6.0, 3.0, 25.0


@dataclass(kw_only=True)
class Stander(Behaviour):
    """Walks to and fro beside the route until the robot has been near for 3 s, then stands for 25 s, and again.

    Attributes:
        pace: Speed [m/s].
        side: Offset from the route [m].
        window: Arc lengths between which they walk [m].
        robot_near_s: For how long the robot was within 6 m since they last stood [s].
        stands_s: For how long they will still stand [s].
    """

    pace: float
    side: float
    window: tuple[float, float]
    robot_near_s: float = 0.0
    stands_s: float = 0.0

    def wish(self, view: PersonView, dt: float) -> Wish:
        """Return the pace, or 0 while they stand."""
        low, high = self.window
        sense = -1.0 if view.arc > high else 1.0 if view.arc < low else view.sense
        if self.stands_s > 0.0:
            self.stands_s = max(0.0, self.stands_s - dt)
            return Wish(0.0, self.side, sense)
        self.robot_near_s += dt if view.robot_distance < _SEES_ROBOT_M else 0.0
        if self.robot_near_s > _WALKS_ON_S:
            self.robot_near_s, self.stands_s = 0.0, _STANDS_S
        return Wish(self.pace, self.side, sense)
