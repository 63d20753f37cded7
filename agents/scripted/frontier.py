"""Exploration by frontiers (Yamauchi 1997): to the nearest place where the known floor ends, again and again."""

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...envs.task.interface import FollowInterface
from ...slam.errors import InputError
from ..protocol.follower import Observation
from .dwa import known_people
from .dynamic_window import DynamicWindow, DynamicWindowConfig, Obstacles
from .frontier_plan import FrontierConfig, FrontierWay, place_ahead, plan_way
from .passed_points import PassedPoints
from .scan_points import ScanPoints, as_action, own_velocity

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class FrontierExplorerConfig:
    """How it explores.

    Attributes:
        plan_s: Time between two plans [s].
        reach: How far ahead on its way the local planner aims [m].
        stuck_s: A frontier is given up when the robot hardly moved for this long [s].
        forget_s: And tried again after this time: people go away [s].
        near: Returns farther than this do not matter to the local planner [m].
        plan: What counts as a frontier and which ways are good.
        window: The local planner.
    """

    plan_s: float = 1.0
    reach: float = 1.0
    stuck_s: float = 4.0
    forget_s: float = 40.0
    near: float = 2.6
    plan: FrontierConfig = field(default_factory=FrontierConfig)
    window: DynamicWindowConfig = field(default_factory=lambda: DynamicWindowConfig(max_speed=0.9))


class FrontierExplorer:
    """Plans on the robot's own map, once a second, and drives by the dynamic window; stands still when all is known.

    Raises:
        InputError: If nothing builds a map in the environment.
    """

    def __init__(self, interface: FollowInterface | None = None, config: FrontierExplorerConfig | None = None) -> None:
        self.interface = interface or FollowInterface()
        if self.interface.own_map is None:
            raise InputError("frontier exploration needs the robot's own map: an environment with `slam`, got none")
        self._own_map = self.interface.own_map
        self.config = config or FrontierExplorerConfig()
        self._step_s = 1.0 / self.interface.control_hz
        self._window = DynamicWindow(self.config.window, self.interface)
        self._points, self._passed = ScanPoints(self.interface), PassedPoints(self.interface)
        self.reset()

    def reset(self) -> None:
        """Forget everything; call it before each episode."""
        self._window.reset()
        self._passed.reset()
        self._way: FrontierWay | None = None
        self._visited: list[Array] = []
        self._given_up: list[tuple[float, Array]] = []
        self._time_s = self._still_s = 0.0
        self._planned_s = -math.inf

    @property
    def done(self) -> bool:
        """Whether no frontier was left at the last plan."""
        return self._way is None and self._planned_s >= 0.0

    def act(self, observation: Observation) -> NDArray[np.float32]:
        """Return the action (forward, turn), or (forward, 0, turn) for a holonomic robot, each in [-1, 1]."""
        self._time_s += self._step_s
        velocity = forward, _, turn = own_velocity(observation)
        points = self._passed.update(self._points.near(observation, self.config.near), velocity)
        moves = abs(forward) > 0.06 or abs(turn) > 0.15
        self._still_s = 0.0 if moves else self._still_s + self._step_s
        if self._time_s - self._planned_s >= self.config.plan_s:
            self._plan()
        if self._way is None:
            self._window.reset()
            return as_action(0.0, 0.0, self.interface)
        target = place_ahead(self._way.places, self._own_map().pose, self.config.reach)
        around = Obstacles(points, known_people(observation))
        return as_action(*self._window.choose(target, target, around), self.interface)

    def _plan(self) -> None:
        own = self._own_map()
        self._planned_s = self._time_s
        if not self._visited or np.hypot(*(own.pose[:2] - self._visited[-1])) > 0.2:
            self._visited.append(own.pose[:2].copy())
        if self._still_s > self.config.stuck_s and self._way is not None:
            self._given_up.append((self._time_s, self._way.frontier))
            self._still_s = 0.0
        self._given_up = [entry for entry in self._given_up if self._time_s - entry[0] < self.config.forget_s]
        refused = np.array([place for _, place in self._given_up]).reshape(-1, 2)
        self._way = plan_way(own, np.array(self._visited), refused, self.interface, self.config.plan)
