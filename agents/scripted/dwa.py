"""A follower by the dynamic window approach: behind the leader, clear of things, out of people's space."""

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...envs.task.interface import FollowInterface
from ..protocol.follower import Observation
from .dynamic_window import DynamicWindow, DynamicWindowConfig, Obstacles
from .leader_memory import Goal, LeaderMemory, MemoryConfig, Mode
from .leader_trail import LeaderTrail
from .passed_points import PassedPoints
from .scan_points import ScanPoints, as_action, leader_row, own_velocity, without

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class DWAConfig:
    """Where to be, and what to mind on the way.

    Attributes:
        distance: Distance kept from the leader, centre to centre [m].
        lookahead: Where the straight way to the place behind the leader is not free, it heads for the farthest point of
            the leader's trail to which it is, among those this near [m].
        nearest: Points of the trail nearer than this are reached [m].
        spacing: Distance between two points of the trail [m].
        ahead_s: The leader is taken to walk on for this long [s].
        body: Returns nearer than this to a leader who is seen are the leader, who walks on, not an obstacle [m].
        near: Returns farther than this do not matter [m].
        passed_s: What has left the laser's view is minded for this long [s].
        window: The dynamic window.
        memory: What it does when the leader is lost.
    """

    distance: float = 1.3
    lookahead: float = 2.0
    nearest: float = 0.6
    spacing: float = 0.1
    ahead_s: float = 1.6
    body: float = 0.45
    near: float = 2.6
    passed_s: float = 3.0
    window: DynamicWindowConfig = field(default_factory=DynamicWindowConfig)
    memory: MemoryConfig = field(default_factory=lambda: MemoryConfig(predicted=True))


class DWAFollower:
    """Heads along the leader's trail for the place behind where it will be, by the best velocity it can stop from."""

    def __init__(self, interface: FollowInterface | None = None, config: DWAConfig | None = None) -> None:
        self.interface = interface or FollowInterface()
        self.config = config or DWAConfig()
        step_s = 1.0 / self.interface.control_hz
        self._memory = LeaderMemory(self.config.memory, step_s)
        self._trail = LeaderTrail(self.config.spacing, step_s)
        self._window = DynamicWindow(self.config.window, self.interface)
        self._points = ScanPoints(self.interface)
        self._passed = PassedPoints(self.interface, self.config.passed_s)
        self.reset()

    def reset(self) -> None:
        """Forget everything; call it before each episode."""
        self._memory.reset()
        self._trail.clear()
        self._passed.reset()
        self._window.reset()

    def act(self, observation: Observation) -> NDArray[np.float32]:
        """Return the action (forward, turn), or (forward, 0, turn) for a holonomic robot, each in [-1, 1]."""
        velocity = own_velocity(observation)
        goal = self._memory.update(leader_row(observation), velocity)
        self._trail.carry_along(velocity)
        around = self._around(observation, goal, velocity)
        if goal.mode is Mode.WAIT:
            self._window.reset()
            return as_action(0.0, 0.0, self.interface)
        if goal.mode is Mode.SEARCH:
            self._trail.clear()
            return as_action(*self._window.turn(self._memory.search_turn, around), self.interface)
        self._trail.extend(goal.x, goal.y)
        target, look_at = self._target(goal, around.obstacles)
        return as_action(*self._window.choose(target, look_at, around), self.interface)

    def _target(self, goal: Goal, obstacles: Array) -> tuple[Array, Array]:
        """Return (2,) where to be and (2,) what to face there, robot frame [m]."""
        here = np.array((goal.x, goal.y))
        leader = here + self.config.ahead_s * np.array((goal.vx, goal.vy))
        keep = self.config.distance if goal.mode is Mode.FOLLOW else 0.0
        gap = math.hypot(leader[0], leader[1])
        behind = leader * (1.0 - keep / gap) if gap > 1e-6 else leader
        trail = self._trail.ahead()
        if self._is_clear(behind, obstacles):
            return behind, leader
        ahead = trail[np.hypot(*trail.T) >= self.config.nearest]
        if not len(ahead):
            return behind, leader
        clear = (point for point in ahead[::-1] if self._is_clear(point, obstacles))
        aim = next(clear, ahead[0])
        return aim, aim

    def _is_clear(self, place: Array, obstacles: Array) -> bool:
        """Return whether the straight way to `place` (2,) is short and not barred by any of the obstacles (n, 2)."""
        length = float(np.hypot(*place))
        if length > self.config.lookahead:
            return False
        if length < 1e-6 or not len(obstacles):
            return True
        along = np.clip(obstacles @ place / length, 0.0, length)
        aside = np.hypot(*(obstacles - along[:, None] * place / length).T)
        return bool(aside.min() >= self.interface.turning_radius)

    def _around(self, observation: Observation, goal: Goal, velocity: tuple[float, float, float]) -> Obstacles:
        people, points = known_people(observation), self._points.near(observation, self.config.near)
        if observation["leader"][5] > 0.5:
            leader = np.array([[goal.x, goal.y, goal.vx, goal.vy]])
            points, people = without(points, leader[:, :2], self.config.body), np.vstack((people, leader))
        return Obstacles(self._passed.update(points, velocity), people)


def known_people(observation: Observation) -> Array:
    """Return (k, 4) x, y, vx, vy of the people in an observation who do not lead [m, m/s]."""
    rows = observation["people"]
    return rows[rows[:, 5] > 0.5, :4].astype(np.float64)
