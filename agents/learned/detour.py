"""What the network is not left alone with: being held up before things, and a leader out of sight.

A network that wishes straight into a door post is stopped by the guard, and would wish so for ever. Whoever stands
though the leader's trail goes on gets a short way from here: manoeuvres of two parts (back, turn or go; then go) are
driven in thought, and the one that comes farthest along the trail without a touch is driven. The same leads who
has lost the leader to where the trail ends; there it looks around.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...envs.task.interface import FollowInterface
from ...slam.errors import InputError
from ..scripted.leader_memory import Mode
from .guard import box_gaps
from .manoeuvres import LONGEST_S, SPACING_M, drive_in_thought, resampled, thinned, turned_away
from .situation import Situation, Wish
from .steering import State, SteeringConfig

Array = NDArray[np.float64]
_REACH_M = 2.5
_MOST_PLANS = 3000
"""Manoeuvres that are tried in a step: about three times as many as by default."""
_BRAKING_M = 0.02
"""Who is to stop going back comes a little farther than it is now [m]; that forbids no manoeuvre."""


@dataclass(frozen=True, kw_only=True)
class DetourConfig:
    """When the network is relieved, and how.

    Attributes:
        distance: From the leader, centre to centre, at which a robot may well stand [m].
        behind: A robot that stands this much of the trail farther off is held up [m].
        held_s: For how long, until it is relieved [s].
        relieved_m: Way after which the network drives again [m].
        relieved_s: Time after which it does anyway [s].
        clear: Gap to things that is wanted on the way [m].
        first_speeds: Speeds of a manoeuvre's first part [m/s].
        then_speeds: Speeds of its second part [m/s].
        turns: Turn rates of either [rad/s].
        first_s: Lengths of the first part [s].
        horizon_s: Length of both parts [s].
        off_trail: What a metre beside the trail costs, in metres along it.
        facing: What a radian of turning from the trail costs [m].
        tight: What no gap at all would cost [m].
        touch: A manoeuvre that comes nearer to things than this is not driven; less than the guard's margin, or the
            laser's noise would forbid one manoeuvre after the other [m].
        keep: What it is worth to go on with the manoeuvre that was begun: who begins another every step stands [m].
        search: Whether a leader out of sight is looked for by this too.
    """

    distance: float = 1.3
    behind: float = 0.5
    held_s: float = 0.8
    relieved_m: float = 0.7
    relieved_s: float = 6.0
    clear: float = 0.2
    first_speeds: tuple[float, ...] = (-0.3, -0.15, 0.0, 0.3, 0.6, 0.9)
    then_speeds: tuple[float, ...] = (0.0, 0.35, 0.8)
    turns: tuple[float, ...] = (-1.2, -0.5, 0.0, 0.5, 1.2)
    first_s: tuple[float, ...] = (0.5, 1.1)
    horizon_s: float = 2.4
    off_trail: float = 1.5
    facing: float = 0.3
    tight: float = 0.4
    touch: float = 0.03
    keep: float = 0.15
    search: bool = True

    def __post_init__(self) -> None:
        if not (self.held_s > 0.0 and self.horizon_s > max(self.first_s)):
            raise InputError("a detour needs `held_s` > 0 and a horizon beyond the first part")
        plans = len(self.first_speeds) * len(self.then_speeds) * len(self.turns) ** 2 * len(self.first_s)
        if plans > _MOST_PLANS or self.horizon_s > LONGEST_S:
            raise InputError(
                f"a detour drives at most {_MOST_PLANS} manoeuvres of {LONGEST_S:g} s in thought, or a step takes "
                f"seconds; got {plans} of {self.horizon_s} s"
            )


class Detour:
    """Watches one episode, and drives where the network cannot.

    Args:
        config: When and how.
        steering: How wishes are driven.
        interface: Length of a step, and the robot's size.
    """

    def __init__(self, config: DetourConfig, steering: SteeringConfig, interface: FollowInterface) -> None:
        self.config, self._steering, self._robot = config, steering, interface
        self._step_s = 1.0 / interface.control_hz
        first = np.array(np.meshgrid(config.first_speeds, config.turns, config.first_s)).reshape(3, -1).T
        then = np.array(np.meshgrid(config.then_speeds, config.turns)).reshape(2, -1).T
        self._plans = np.hstack((np.repeat(first, len(then), axis=0), np.tile(then, (len(first), 1))))
        self.reset()

    def reset(self) -> None:
        """Forget everything."""
        self._held_s = self._left_s = self._left_m = 0.0
        self._begun = np.zeros((0, 5))

    def escape(self, wish: Wish, situation: Situation) -> Wish:
        """Return `wish`, or what is to be wished instead; once a step."""
        state, goal = situation.commanded, situation.goal
        if goal.mode is Mode.WAIT:
            return wish
        if goal.mode is Mode.SEARCH and self.config.search:
            return 0.0, situation.search_turn
        lost = goal.mode is Mode.APPROACH and self.config.search
        path = resampled(np.vstack((situation.trail, (goal.x, goal.y))), 0.0 if lost else self.config.distance)
        self._watch(state, len(path) * SPACING_M)
        if not (lost or self._left_s > 0.0) or not len(path):
            self._begun = np.zeros((0, 5))
            return wish
        return self._best(state, path, situation.things, situation.room_behind())

    def _watch(self, state: State, behind: float) -> None:
        """Notice that the robot is held up, or has been relieved for long enough."""
        c = self.config
        self._left_s = max(self._left_s - self._step_s, 0.0)
        self._left_m -= abs(state[0]) * self._step_s
        if self._left_m <= 0.0 or behind < 0.5 * c.behind:
            self._left_s = 0.0
        stands = abs(state[0]) < 0.08 and behind > c.behind
        self._held_s = self._held_s + self._step_s if stands else max(self._held_s - 2.0 * self._step_s, 0.0)
        if self._held_s > c.held_s and self._left_s == 0.0:
            self._held_s, self._left_s, self._left_m = 0.0, c.relieved_s, c.relieved_m

    def _best(self, state: State, path: Array, things: Array, room: float) -> Wish:
        """Return what the best manoeuvre wishes now, and remember it as begun."""
        c, plans = self.config, np.vstack((self._plans, self._begun))
        near = thinned(things, _REACH_M)
        driven = drive_in_thought(state, plans, near, c.horizon_s, self._step_s, self._steering, self._robot)
        poses, gap = driven.poses, driven.gaps
        now = float(box_gaps(np.zeros((1, 3)), near, self._robot).min(initial=np.inf))
        arc = SPACING_M * np.arange(1, len(path) + 1)
        off = np.hypot(path[:, 0] - poses[:, :1], path[:, 1] - poses[:, 1:2])
        reached = c.off_trail * off - arc
        k = np.argmin(reached, axis=1)
        ahead = path[np.minimum(k + 4, len(path) - 1)]
        tight = np.maximum(1.0 - gap / c.clear, 0.0) ** 2
        cost = reached[np.arange(len(k)), k] + c.facing * turned_away(poses, ahead) + c.tight * tight
        cost[(gap < min(c.touch, now - 0.002)) | (driven.back > room + _BRAKING_M)] += 100.0
        cost[len(self._plans) :] -= c.keep
        best = plans[int(np.argmin(cost))].copy()
        wish = best[:2] if best[2] > 0.0 else best[3:]
        best[2] = max(best[2] - self._step_s, 0.0)
        self._begun = best[None]
        return float(wish[0]), float(wish[1])


class NoDetour:
    """Leaves the network alone."""

    def reset(self) -> None:
        """Forget nothing."""

    def escape(self, wish: Wish, situation: Situation) -> Wish:
        """Return `wish`."""
        return wish
