"""Exploration at random: straight on until something is in the way, then another way."""

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...envs.task.interface import FollowInterface
from ..protocol.follower import Observation
from .avoidance import AvoidanceConfig, free_lengths
from .dwa import known_people
from .dynamic_window import DynamicWindow, DynamicWindowConfig, Obstacles
from .passed_points import PassedPoints
from .scan_points import ScanPoints, as_action, own_velocity

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class RandomWalkConfig:
    """How it wanders.

    Attributes:
        seed: Of the draws; each `reset` begins with it again.
        room: A new direction is taken when less than this is free in the present one [m].
        stuck_s: Or when the robot hardly moved for this long [s].
        reach: How far ahead the local planner aims [m].
        window: The local planner.
        avoidance: How free ways are measured.
    """

    seed: int = 0
    room: float = 0.5
    stuck_s: float = 2.0
    reach: float = 1.5
    window: DynamicWindowConfig = field(default_factory=lambda: DynamicWindowConfig(max_speed=0.9))
    avoidance: AvoidanceConfig = field(default_factory=lambda: AvoidanceConfig(horizon=2.5))


class RandomWalk:
    """Drives straight on while it can; else it draws a direction, among those that are free if there are any."""

    def __init__(self, interface: FollowInterface | None = None, config: RandomWalkConfig | None = None) -> None:
        self.interface = interface or FollowInterface()
        self.config = config or RandomWalkConfig()
        self._step_s = 1.0 / self.interface.control_hz
        self._window = DynamicWindow(self.config.window, self.interface)
        self._points, self._passed = ScanPoints(self.interface), PassedPoints(self.interface)
        self.reset()

    def reset(self) -> None:
        """Forget everything; call it before each episode."""
        self._rng = np.random.default_rng(self.config.seed)
        self._window.reset()
        self._passed.reset()
        self._heading = self._still_s = 0.0

    def act(self, observation: Observation) -> NDArray[np.float32]:
        """Return the action (forward, turn), or (forward, 0, turn) for a holonomic robot, each in [-1, 1]."""
        velocity = forward, left, turn = own_velocity(observation)
        self._heading = (self._heading - turn * self._step_s + math.pi) % (2.0 * math.pi) - math.pi
        self._still_s = 0.0 if math.hypot(forward, left) > 0.08 or abs(turn) > 0.2 else self._still_s + self._step_s
        points = self._points.near(observation, self.config.avoidance.horizon + 1.0)
        self._maybe_turn(points)
        around = Obstacles(self._passed.update(points, velocity), known_people(observation))
        target = self.config.reach * np.array((math.cos(self._heading), math.sin(self._heading)))
        return as_action(*self._window.choose(target, target, around), self.interface)

    def _maybe_turn(self, points: Array) -> None:
        c = self.config
        ahead = float(free_lengths(np.array([self._heading]), points, c.avoidance, self.interface)[0])
        if ahead >= c.room and self._still_s < c.stuck_s:
            return
        self._still_s = 0.0
        ways = self._rng.uniform(-math.pi, math.pi, 24)
        free = free_lengths(ways, points, c.avoidance, self.interface) > 2.0 * c.room
        self._heading = float(ways[int(np.argmax(free))])
