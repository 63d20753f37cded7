"""Who leads the robot: walks the route, pauses, turns round, and has a style."""

from dataclasses import dataclass, field

import numpy as np

from .behaviour import Behaviour, Wish
from .making_room import group_offset
from .view import PersonView

STYLES = {"steady": (0.75, 1.0), "hurried": (1.0, 1.15), "waits": (0.8, 1.05)}
"""Style -> range of the walking speed [m/s]. Who "waits" stops when the robot lags behind."""
_PAUSE_EVERY = (9.0, 18.0)
_PAUSE_TIME = (1.5, 4.0)
_LAG_STOP, _LAG_GO = 2.6, 1.9


@dataclass(kw_only=True)
class Leader(Behaviour):
    """Leads the robot along its route to the end of the tour.

    Attributes:
        style: One of `STYLES`.
        pace: Walking speed [m/s].
        side: Preferred offset from the route [m].
        stop_at: Arc length of the end of the tour [m].
        pauses: Arc length [m], duration [s], and whether they turn to the robot, of each pause; the next one first.
        pause_left: Rest of the present pause [s].
        looks_back: Whether they turn to the robot in the present pause.
        waiting: Whether they wait for the robot.
        done: Whether the tour's end was reached.
    """

    style: str
    pace: float
    stop_at: float
    side: float = 0.0
    pauses: list[tuple[float, float, bool]] = field(default_factory=list)
    pause_left: float = 0.0
    looks_back: bool = False
    waiting: bool = False
    done: bool = False

    def wish(self, view: PersonView, dt: float) -> Wish:
        """Return the pace, or 0 in a pause, while waiting for the robot, and at the end of the tour."""
        speed = self._speed(dt, view.arc, view.robot_distance)
        face = view.robot_direction if self.looks_back else view.way.heading
        return Wish(speed, group_offset(view, self.side), face=face)

    def _speed(self, dt: float, arc: float, robot_distance: float) -> float:
        self.done = self.done or arc >= self.stop_at
        if self.done:
            return 0.0
        if self.style == "waits":
            self.waiting = robot_distance > (_LAG_GO if self.waiting else _LAG_STOP)
        if self.pause_left > 0.0:
            self.pause_left = max(0.0, self.pause_left - dt)
            return 0.0
        self.looks_back = self.waiting
        if self.pauses and arc >= self.pauses[0][0]:
            _, self.pause_left, self.looks_back = self.pauses.pop(0)
            return 0.0
        return 0.0 if self.waiting else self.pace


def draw_leader(rng: np.random.Generator, style: str | None, start: float, stop_at: float) -> Leader:
    """Return a leader who starts at arc `start` and ends the tour at `stop_at` [m]; a `style` of None is drawn."""
    drawn = str(rng.choice(sorted(STYLES)))
    low, high = STYLES[style or drawn]
    leader = Leader(style=style or drawn, pace=float(rng.uniform(low, high)), stop_at=stop_at)
    leader.pauses.append((0.0, float(rng.uniform(0.5, 1.5)), False))
    arc = start + rng.uniform(*_PAUSE_EVERY)
    while arc < stop_at - 3.0:
        leader.pauses.append((float(arc), float(rng.uniform(*_PAUSE_TIME)), bool(rng.random() < 0.5)))
        arc += rng.uniform(*_PAUSE_EVERY)
    return leader
