"""Keeping up: who falls behind is not left to hesitate.

The teacher, who knows where its leader is, may well linger; the robot that does loses sight of it at the next corner.
So the wished speed is at least what a pursuit law asks for: the leader's own pace and more for what is too much of the
way to it, less while the way is not ahead.
"""

import math
from dataclasses import dataclass

import numpy as np

from ...slam.errors import InputError
from ..scripted.leader_memory import Mode
from .situation import Situation, Wish


@dataclass(frozen=True, kw_only=True)
class KeepUpConfig:
    """What is asked for.

    Attributes:
        distance: Wanted behind the leader, along its trail [m].
        gain: Speed for a metre of way beyond that [1/s].
        pace: Share of the leader's speed along the line of sight that is kept [-].
        ahead: The way is ahead if the point so far along the trail is [m].
    """

    distance: float = 1.35
    gain: float = 1.2
    pace: float = 1.0
    ahead: float = 0.8

    def __post_init__(self) -> None:
        if not (self.distance > 0.0 and self.gain >= 0.0 and self.ahead > 0.0):
            raise InputError("keeping up needs `distance` > 0, `gain` >= 0 and `ahead` > 0")


class KeepUp:
    """Speeds up who falls behind; without memory.

    Args:
        config: What is asked for.
    """

    def __init__(self, config: KeepUpConfig) -> None:
        self.config = config

    def keep_pace(self, wish: Wish, situation: Situation) -> Wish:
        """Return `wish`, faster if its speed lets the leader get away."""
        goal, trail = situation.goal, situation.trail
        if goal.mode is not Mode.FOLLOW:
            return wish
        c, path = self.config, np.vstack((np.zeros(2), trail, (goal.x, goal.y)))
        arc = np.append(0.0, np.cumsum(np.hypot(*np.diff(path, axis=0).T)))
        way = math.atan2(*(float(np.interp(c.ahead, arc, path[:, k])) for k in (1, 0)))
        pace = (goal.vx * goal.x + goal.vy * goal.y) / max(goal.distance, 0.1)
        least = c.pace * pace + c.gain * (float(arc[-1]) - c.distance)
        return max(wish[0], least * max(math.cos(way), 0.0) ** 2), wish[1]


class NoKeepUp:
    """Leaves the network alone."""

    def keep_pace(self, wish: Wish, situation: Situation) -> Wish:
        """Return `wish`."""
        return wish
