"""Where the follower takes its leader to be: smoothed while it is seen, remembered while it is not."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum

from ...slam.errors import InputError

_TURNS_BACK = 0.05
"""Share of the rate of the search below which something is in the way."""


class Mode(Enum):
    """What the follower is doing."""

    WAIT = "wait"
    """No leader has been seen yet."""
    FOLLOW = "follow"
    """The leader is seen, or was a moment ago."""
    APPROACH = "approach"
    """On the way to where the leader would be or was last seen."""
    SEARCH = "search"
    """Standing, then turning on the spot, looking for the leader."""


@dataclass(frozen=True, kw_only=True)
class MemoryConfig:
    """How a leader is smoothed, and when it is given up and looked for.

    Attributes:
        position_s: Time constant with which a seen place corrects the smoothed one [s]: feet swing, bodies do not.
        velocity_s: Time constant with which a seen velocity corrects the smoothed one [s].
        jump_m: A place farther than this from the smoothed one is believed at once [m].
        patience_s: How long an unseen leader is followed as if it was seen [s].
        extrapolate_s: How long an unseen leader is taken to walk on at its last velocity [s].
        arrived_m: Distance from the remembered place at which the search begins [m].
        approach_s: Time after which the search begins anyway [s].
        dwell_s: Time that the search looks around standing still, before it turns: the laser sees three quarters of a
            circle, and people are found sooner from a robot at rest [s].
        search_turn_rate: Turn rate of the search [rad/s].
        predicted: Whether a lost leader is approached where the tracker takes it to be by now, if it says so, instead
            of where it would be at its last velocity.
    """

    position_s: float = 0.3
    velocity_s: float = 0.1
    jump_m: float = 0.6
    patience_s: float = 0.6
    extrapolate_s: float = 1.0
    arrived_m: float = 0.5
    approach_s: float = 8.0
    dwell_s: float = 3.0
    search_turn_rate: float = 0.5
    predicted: bool = False

    def __post_init__(self) -> None:
        if not self.search_turn_rate > 0.0:
            raise InputError(f"`search_turn_rate` must be positive [rad/s], got {self.search_turn_rate}")


@dataclass
class Goal:
    """Where the leader is taken to be, in the robot frame: x, y [m], vx, vy over ground [m/s], and what to do."""

    mode: Mode = Mode.WAIT
    x: float = 0.0
    y: float = 0.0
    vx: float = 0.0
    vy: float = 0.0

    @property
    def distance(self) -> float:
        """Distance from the robot's centre [m]."""
        return math.hypot(self.x, self.y)

    @property
    def bearing(self) -> float:
        """Direction in the robot frame [rad]."""
        return math.atan2(self.y, self.x)


class LeaderMemory:
    """Keeps the leader's last place in the moving robot frame by the robot's own velocity.

    Attributes:
        goal: Of the last step.
    """

    def __init__(self, config: MemoryConfig, step_s: float) -> None:
        self._config, self._step_s = config, step_s
        self.reset()

    def reset(self) -> None:
        """Forget the leader."""
        self.goal = Goal()
        self._unseen_s = self._searching_s = 0.0
        self._side = 1.0

    def update(self, leader: list[float], velocity: tuple[float, float, float]) -> Goal:
        """Return the goal of this step.

        Args:
            leader: Observation `leader`.
            velocity: The robot's own (forward, left, turn) during the last step [m/s, m/s, rad/s].
        """
        self._carry_along(velocity)
        if leader[5] > 0.5:
            self._correct(leader)
        elif self.goal.mode is not Mode.WAIT:
            self._unseen_s += self._step_s
            self.goal.mode = self._lost_mode()
            if self._config.predicted and self.goal.mode is Mode.APPROACH and any(leader[:2]):
                self.goal.x, self.goal.y = leader[:2]
        return self.goal

    def _correct(self, leader: list[float]) -> None:
        x, y, vx, vy = leader[:4]
        goal, c = self.goal, self._config
        if goal.mode is not Mode.FOLLOW or math.hypot(x - goal.x, y - goal.y) > c.jump_m:
            self.goal = Goal(Mode.FOLLOW, x, y, vx, vy)
        else:
            place, speed = (self._step_s / (self._step_s + time_s) for time_s in (c.position_s, c.velocity_s))
            goal.x, goal.y = goal.x + place * (x - goal.x), goal.y + place * (y - goal.y)
            goal.vx, goal.vy = goal.vx + speed * (vx - goal.vx), goal.vy + speed * (vy - goal.vy)
        self._unseen_s = 0.0
        self._side = math.copysign(1.0, self.goal.y + 0.5 * self.goal.vy)

    def _lost_mode(self) -> Mode:
        if self._unseen_s <= self._config.patience_s:
            return Mode.FOLLOW
        if self.goal.mode is Mode.SEARCH:
            self._searching_s += self._step_s
            return Mode.SEARCH
        arrived = self.goal.distance < self._config.arrived_m or self._unseen_s > self._config.approach_s
        self._searching_s = 0.0
        return Mode.SEARCH if arrived else Mode.APPROACH

    @property
    def search_turn(self) -> float:
        """Turn rate of the search now [rad/s]: nothing at first, then towards where the leader went."""
        return 0.0 if self._searching_s < self._config.dwell_s else self._side * self._config.search_turn_rate

    def look_around(self, kept: Callable[[float], float]) -> float:
        """Return `search_turn` as far as the robot can turn where it stands [rad/s]; the next time it turns back.

        Args:
            kept: Returns how fast it can turn, of a rate that is wished for.
        """
        wish = self.search_turn
        turn = kept(wish)
        if abs(turn) < _TURNS_BACK * abs(wish):
            self._side = -self._side
        return turn

    def _carry_along(self, velocity: tuple[float, float, float]) -> None:
        goal, step = self.goal, self._step_s
        if self._unseen_s > self._config.extrapolate_s:
            goal.vx = goal.vy = 0.0
        x = goal.x + (goal.vx - velocity[0]) * step
        y = goal.y + (goal.vy - velocity[1]) * step
        cos, sin = math.cos(-velocity[2] * step), math.sin(-velocity[2] * step)
        goal.x, goal.y = cos * x - sin * y, sin * x + cos * y
        goal.vx, goal.vy = cos * goal.vx - sin * goal.vy, sin * goal.vx + cos * goal.vy
