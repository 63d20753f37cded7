"""Swerving in time: a wish that would touch something in the next second gives way to the nearest one that does not.

The guard behind it brakes at the last moment, and who has been stopped with a corner before a door post has lost two
seconds, and often the leader. So what is wished is driven in thought; if it comes too near to things, others like it
are tried, slower and turning otherwise, and weighed by how much they change, whether they face the leader, and how near
to its trail they end: where the leader walked there is room. Bystanders are minded where they walk to: who waits for
one to clear the doorway, or turns away from one who leaves, is too late.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...envs.task.interface import FollowInterface
from ...slam.errors import InputError
from ..scripted.leader_memory import Mode
from .guard import GuardConfig
from .manoeuvres import LONGEST_S, Driven, drive_in_thought, resampled, thinned, turned_away
from .situation import Situation, Wish
from .steering import State, SteeringConfig

Array = NDArray[np.float64]
_REACH_M = 2.2
_WALKS_MPS, _BODY_M = 0.2, 0.45


@dataclass(frozen=True, kw_only=True)
class SwerveConfig:
    """When to swerve, and how.

    Attributes:
        ahead_s: How far wishes are driven in thought [s].
        foresight_s: Bystanders who walk are minded where they will be after this time [s].
        trigger: Others are tried when the wish comes nearer to things than this [m].
        clear: Gap that is wanted on the way [m].
        shares: Of the wished speed that are tried.
        turns: Turn rates that are tried, beside the wished one [rad/s].
        slower: What a m/s of change costs.
        turning: What a rad/s of change costs.
        off_trail: What a metre between the end and the leader's trail costs.
        facing: What a radian costs between the end's heading and where the leader will be: who turns away from a corner
            that the leader goes round loses sight of it.
        tight: What no gap at all would cost.
        blocked: What a gap less than the guard's costs: it would stop the robot.
    """

    ahead_s: float = 1.2
    foresight_s: float = 0.6
    trigger: float = 0.1
    clear: float = 0.16
    shares: tuple[float, ...] = (0.25, 0.5, 0.75, 1.0)
    turns: tuple[float, ...] = (-1.5, -1.25, -1.0, -0.75, -0.5, -0.25, 0.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5)
    slower: float = 1.0
    turning: float = 0.3
    off_trail: float = 1.0
    facing: float = 0.3
    tight: float = 0.6
    blocked: float = 2.0

    def __post_init__(self) -> None:
        if not (0.0 < self.ahead_s <= LONGEST_S and self.clear > 0.0):
            needs = f"`ahead_s` > 0, at most {LONGEST_S:g} s, and `clear` > 0"
            raise InputError(f"swerving needs {needs}, got {self.ahead_s}, {self.clear}")


class Swerve:
    """Looks ahead; without memory.

    Args:
        config: When and how.
        guard: The gap that is kept.
        steering: How wishes are driven.
        interface: Length of a step, and the robot's size.
    """

    def __init__(
        self, config: SwerveConfig, guard: GuardConfig, steering: SteeringConfig, interface: FollowInterface
    ) -> None:
        self.config, self._guard, self._steering, self._robot = config, guard, steering, interface
        self._step_s = 1.0 / interface.control_hz

    def avoid(self, wish: Wish, situation: Situation) -> Wish:
        """Return `wish`, or the one that is nearest to it and comes not too near to things."""
        state, goal = situation.commanded, situation.goal
        near = thinned(foreseen(situation.things, situation.people, self.config.foresight_s), _REACH_M)
        if goal.mode is not Mode.FOLLOW or not len(near) or max(wish[0], state[0]) < 0.1:
            return wish
        if self._driven(state, np.array([wish]), near).gaps[0] >= self.config.trigger:
            return wish
        c = self.config
        speeds, turns = np.array(c.shares) * wish[0], np.append(c.turns, wish[1])
        tried = np.vstack((wish, np.stack(np.meshgrid(speeds, turns), axis=-1).reshape(-1, 2)))
        driven = self._driven(state, tried, near)
        tight = np.maximum(1.0 - driven.gaps / c.clear, 0.0) ** 2
        cost = c.slower * np.abs(tried[:, 0] - wish[0]) + c.turning * np.abs(tried[:, 1] - wish[1]) + c.tight * tight
        then = np.array((goal.x + goal.vx * c.ahead_s, goal.y + goal.vy * c.ahead_s))
        cost += c.blocked * (driven.gaps < self._guard.margin) + c.facing * turned_away(driven.poses, then)
        path = resampled(np.vstack((situation.trail, (goal.x, goal.y))), 0.0)
        if len(path):
            x, y = driven.poses[:, :1], driven.poses[:, 1:2]
            cost += c.off_trail * np.hypot(path[:, 0] - x, path[:, 1] - y).min(axis=1)
        best = tried[int(np.argmin(cost))]
        return float(best[0]), float(best[1])

    def _driven(self, state: State, wishes: Array, things: Array) -> Driven:
        plans = np.column_stack((wishes, np.full(len(wishes), np.inf), wishes))
        return drive_in_thought(state, plans, things, self.config.ahead_s, self._step_s, self._steering, self._robot)


def foreseen(things: Array, people: Array, ahead_s: float) -> Array:
    """Return `things` (n, 2), those of bystanders who walk (m, 6, as in the observation) moved by `ahead_s` [s]."""
    moved = things.copy()
    for x, y, vx, vy, _, there in people.tolist():
        if there > 0.5 and np.hypot(vx, vy) > _WALKS_MPS:
            theirs = np.hypot(things[:, 0] - x, things[:, 1] - y) < _BODY_M
            moved[theirs] = things[theirs] + (vx * ahead_s, vy * ahead_s)
    return moved


class NoSwerve:
    """Leaves it to the guard."""

    def avoid(self, wish: Wish, situation: Situation) -> Wish:
        """Return `wish`."""
        return wish
