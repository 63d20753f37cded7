"""A follower by the dynamic window approach: behind the leader, clear of things, out of people's space."""

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...envs.task.interface import FollowInterface
from ..protocol.follower import Observation
from .dynamic_window import DynamicWindow, DynamicWindowConfig, Obstacles
from .leader_memory import Goal, LeaderMemory, MemoryConfig, Mode
from .scan_points import ScanPoints, as_action, leader_row, own_velocity, without

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class DWAConfig:
    """Where to be, and what to mind on the way.

    Attributes:
        distance: Distance kept from the leader, centre to centre [m].
        ahead_s: The leader is taken to walk on for this long [s].
        body: Returns nearer than this to a leader who is seen are the leader, who walks on, not an obstacle [m].
        near: Returns farther than this do not matter [m].
        window: The dynamic window.
        memory: What it does when the leader is lost.
    """

    distance: float = 1.3
    ahead_s: float = 1.6
    body: float = 0.45
    near: float = 2.6
    window: DynamicWindowConfig = field(default_factory=DynamicWindowConfig)
    memory: MemoryConfig = field(default_factory=MemoryConfig)


class DWAFollower:
    """Heads for the place behind where the leader will be, by the best velocity that it can reach and stop from."""

    def __init__(self, interface: FollowInterface | None = None, config: DWAConfig | None = None) -> None:
        self.interface = interface or FollowInterface()
        self.config = config or DWAConfig()
        self._memory = LeaderMemory(self.config.memory, 1.0 / self.interface.control_hz)
        self._window = DynamicWindow(self.config.window, self.interface)
        self._points = ScanPoints(self.interface)
        self.reset()

    def reset(self) -> None:
        """Forget everything; call it before each episode."""
        self._memory.reset()
        self._window.reset()

    def act(self, observation: Observation) -> NDArray[np.float32]:
        """Return the action (forward, turn), or (forward, 0, turn) for a holonomic robot, each in [-1, 1]."""
        goal = self._memory.update(leader_row(observation), own_velocity(observation))
        if goal.mode is Mode.WAIT:
            self._window.reset()
            return as_action(0.0, 0.0, self.interface)
        if goal.mode is Mode.SEARCH:
            self._window.reset()
            return as_action(0.0, self._memory.search_turn, self.interface)
        target, leader = self._target(goal)
        around = self._around(observation, goal)
        return as_action(*self._window.choose(target, leader, around), self.interface)

    def _target(self, goal: Goal) -> tuple[Array, Array]:
        """Return (2,) where to be and (2,) where the leader will be, robot frame [m]."""
        here = np.array((goal.x, goal.y))
        leader = here + self.config.ahead_s * np.array((goal.vx, goal.vy))
        keep = self.config.distance if goal.mode is Mode.FOLLOW else 0.0
        gap = math.hypot(leader[0], leader[1])
        return leader * (1.0 - keep / gap) if gap > 1e-6 else leader, leader

    def _around(self, observation: Observation, goal: Goal) -> Obstacles:
        people = known_people(observation)
        points = self._points.near(observation, self.config.near)
        if observation["leader"][5] > 0.5:
            leader = np.array([[goal.x, goal.y, goal.vx, goal.vy]])
            return Obstacles(without(points, leader[:, :2], self.config.body), np.vstack((people, leader)))
        return Obstacles(points, people)


def known_people(observation: Observation) -> Array:
    """Return (k, 4) x, y, vx, vy of the people in an observation who do not lead [m, m/s]."""
    rows = observation["people"]
    return rows[rows[:, 5] > 0.5, :4].astype(np.float64)
