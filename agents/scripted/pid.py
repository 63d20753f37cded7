"""A follower by two PID controllers: distance by forward speed, bearing by turn rate (Ye et al., section II-C)."""

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...envs.task.interface import FollowInterface
from ...slam.bounds import check_positive
from ..protocol.follower import Observation
from .avoidance import AvoidanceConfig, FreeHeading, free_heading, kept_turn, stopping_speed
from .ground_behind import GroundBehind
from .leader_memory import Goal, LeaderMemory, MemoryConfig, Mode
from .pid_axis import Axis, AxisConfig
from .scan_points import ScanPoints, as_action, leader_row, own_velocity, without

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class PIDConfig:
    """Gains and limits of the follower.

    Attributes:
        distance: Distance kept from the leader, centre to centre [m].
        linear: Gains from the error of the distance [m] to forward speed [m/s].
        angular: Gains from the bearing [rad] to turn rate [rad/s].
        feed_forward: Share of the leader's speed along the line of sight that is added to the forward speed [-].
        reverse_speed: Fastest backing away from a leader who comes near, over ground known to be free [m/s].
        acceleration: Limit on the growth of the forward speed [m/s^2].
        braking: Limit on its decrease [m/s^2].
        reaction_s: Time until a command takes hold; speed towards things allows for it [s].
        approach_speed: Fastest on the way to where a lost leader was last seen [m/s].
        turn_acceleration: Limit on the change of the turn rate [rad/s^2].
        leader_clearance: Returns nearer than this to a person who is seen are that person, not an obstacle [m].
        avoidance: How the robot keeps clear of things.
        memory: What it does when the leader is lost.
    """

    distance: float = 1.3
    linear: AxisConfig = field(default_factory=lambda: AxisConfig(proportional=1.2, integral=0.1, derivative=0.1))
    angular: AxisConfig = field(default_factory=lambda: AxisConfig(proportional=1.8, derivative=0.1))
    feed_forward: float = 0.9
    reverse_speed: float = 0.5
    acceleration: float = 1.5
    braking: float = 1.5
    reaction_s: float = 0.25
    approach_speed: float = 0.9
    turn_acceleration: float = 3.0
    leader_clearance: float = 0.45
    avoidance: AvoidanceConfig = field(default_factory=AvoidanceConfig)
    memory: MemoryConfig = field(default_factory=MemoryConfig)

    def __post_init__(self) -> None:
        check_positive(self, "distance", "acceleration", "braking", "turn_acceleration")


class PIDFollower:
    """Keeps a fixed distance behind the leader; angular and linear velocity are controlled independently.

    While the leader is out of sight it goes to where it saw it last, then turns and looks for it.
    """

    def __init__(self, interface: FollowInterface | None = None, config: PIDConfig | None = None) -> None:
        self.interface = interface or FollowInterface()
        self.config = config or PIDConfig()
        self._step_s = 1.0 / self.interface.control_hz
        self._linear = Axis(self.config.linear, self._step_s)
        self._angular = Axis(self.config.angular, self._step_s)
        self._memory = LeaderMemory(self.config.memory, self._step_s)
        self._points, self._behind = ScanPoints(self.interface), GroundBehind(self.interface)
        self.reset()

    def reset(self) -> None:
        """Forget everything; call it before each episode."""
        self._linear.reset()
        self._angular.reset()
        self._memory.reset()
        self._behind.reset()
        self._speed = self._turn = self._deviation = 0.0

    def act(self, observation: Observation) -> NDArray[np.float32]:
        """Return the action (forward, turn), or (forward, 0, turn) for a holonomic robot, each in [-1, 1]."""
        velocity = own_velocity(observation)
        self._behind.observe(observation)
        goal = self._memory.update(leader_row(observation), velocity)
        if goal.mode is Mode.WAIT:
            return self._command(0.0, 0.0)
        obstacles = self._obstacles(observation, goal)
        if goal.mode is Mode.SEARCH:
            return self._command(0.0, self._memory.look_around(lambda turn: self._kept_turn(turn, obstacles)))
        way = free_heading(
            goal.bearing, goal.distance, obstacles, self._deviation, self.config.avoidance, self.interface
        )
        self._deviation = way.heading - goal.bearing
        return self._command(*self._follow(goal, way, obstacles))

    def _follow(self, goal: Goal, way: FreeHeading, obstacles: Array) -> tuple[float, float]:
        c, wish = self.config, self._angular.update(way.heading)
        turn = self._kept_turn(wish, obstacles)
        keep = c.distance if goal.mode is Mode.FOLLOW else 0.0
        pace = (goal.vx * math.cos(goal.bearing) + goal.vy * math.sin(goal.bearing)) * c.feed_forward
        top = self.interface.max_speed if goal.mode is Mode.FOLLOW else c.approach_speed
        speed = self._linear.update(goal.distance - keep, saturated=abs(self._speed) >= top) + pace
        onward = 1.0 - turn / wish if wish else 0.0  # who cannot turn here goes on until it can
        speed = min(max(speed, -c.reverse_speed), top * max(max(0.0, math.cos(way.heading)) ** 2, onward))
        if speed < 0.0:
            speed = max(speed, -self._safe_speed(self._behind.room() - c.avoidance.front))
        return min(speed, self._safe_speed(way.ahead)), turn

    def _safe_speed(self, room: float) -> float:
        """Return the speed from which the robot stops within `room` [m], its reaction time included [m/s]."""
        return stopping_speed(room, self.config.braking, self.config.reaction_s)

    def _kept_turn(self, wish: float, obstacles: Array) -> float:
        """Return the turn rate nearest to `wish` that ends before a corner meets one of `obstacles` (n, 2) [rad/s]."""
        c = self.config
        return kept_turn(wish, obstacles, c.turn_acceleration, c.reaction_s, c.avoidance, self.interface)

    def _command(self, speed: float, turn: float) -> NDArray[np.float32]:
        more, less = self.config.acceleration * self._step_s, self.config.braking * self._step_s
        most_turn = self.config.turn_acceleration * self._step_s
        top, top_turn = self.interface.max_speed, self.interface.max_turn_rate
        self._speed = min(max(speed, self._speed - less, -top), self._speed + more, top)
        self._turn = min(max(turn, self._turn - most_turn, -top_turn), self._turn + most_turn, top_turn)
        return as_action(self._speed, self._turn, self.interface)

    def _obstacles(self, observation: Observation, goal: Goal) -> Array:
        """Return (n, 2) returns in the robot frame that are near and not the leader's [m]."""
        points = self._points.near(observation, self.config.avoidance.horizon + 1.0)
        if observation["leader"][5] < 0.5:
            return points
        return without(points, np.array([[goal.x, goal.y]]), self.config.leader_clearance)
