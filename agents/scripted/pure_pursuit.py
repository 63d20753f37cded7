"""A follower by pure pursuit (Coulter 1992): on the leader's own trail instead of straight at the leader."""

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...envs.task.interface import FollowInterface
from ...slam.errors import InputError
from ..protocol.follower import Observation
from .avoidance import AvoidanceConfig, FreeHeading, free_heading, kept_turn
from .ground_behind import GroundBehind
from .leader_memory import Goal, LeaderMemory, MemoryConfig, Mode
from .leader_trail import LeaderTrail
from .scan_points import ScanPoints, as_action, leader_row, own_velocity, without

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class PurePursuitConfig:
    """How the trail is followed.

    Attributes:
        distance: Distance kept from the leader, centre to centre [m].
        lookahead: The point on the trail that is steered for lies this far away [m].
        spacing: Distance between two points of the trail [m].
        catch_up: Forward speed per metre that the leader is too far away, beside its own speed [1/s].
        reverse_speed: Fastest backing away from a leader who comes near, over ground known to be free [m/s].
        acceleration: Limit on the change of the forward speed [m/s^2].
        turn_acceleration: Limit on the change of the turn rate [rad/s^2].
        reaction_s: Time until a command takes hold; turns towards things allow for it [s].
        pivot: Bearing of the aim beyond which the robot turns on the spot [rad].
        pivot_gain: Turn rate per bearing while it does [1/s].
        body: Returns nearer than this to a leader who is seen are the leader, not an obstacle [m].
        avoidance: How the robot keeps clear of things.
        memory: What it does when the leader is lost.
    """

    distance: float = 1.3
    lookahead: float = 0.8
    spacing: float = 0.1
    catch_up: float = 1.0
    reverse_speed: float = 0.5
    acceleration: float = 1.5
    turn_acceleration: float = 3.0
    reaction_s: float = 0.25
    pivot: float = 0.8
    pivot_gain: float = 1.8
    body: float = 0.45
    avoidance: AvoidanceConfig = field(default_factory=AvoidanceConfig)
    memory: MemoryConfig = field(default_factory=MemoryConfig)

    def __post_init__(self) -> None:
        for name in ("distance", "lookahead", "spacing", "acceleration", "turn_acceleration"):
            if not getattr(self, name) > 0.0:
                raise InputError(f"`{name}` of pure pursuit must be positive, got {getattr(self, name)}")


class PurePursuitFollower:
    """Drives along arcs to a point of the leader's trail, so it goes round corners where the leader did."""

    def __init__(self, interface: FollowInterface | None = None, config: PurePursuitConfig | None = None) -> None:
        self.interface = interface or FollowInterface()
        self.config = config or PurePursuitConfig()
        self._step_s = 1.0 / self.interface.control_hz
        self._memory = LeaderMemory(self.config.memory, self._step_s)
        self._trail = LeaderTrail(self.config.spacing, self._step_s)
        self._points, self._behind = ScanPoints(self.interface), GroundBehind(self.interface)
        self.reset()

    def reset(self) -> None:
        """Forget everything; call it before each episode."""
        self._memory.reset()
        self._behind.reset()
        self._trail.clear()
        self._speed = self._turn = self._deviation = 0.0

    def act(self, observation: Observation) -> NDArray[np.float32]:
        """Return the action (forward, turn), or (forward, 0, turn) for a holonomic robot, each in [-1, 1]."""
        velocity = own_velocity(observation)
        self._behind.observe(observation)
        goal = self._memory.update(leader_row(observation), velocity)
        self._trail.carry_along(velocity)
        if goal.mode is Mode.WAIT:
            return self._command(0.0, 0.0)
        points = self._points.near(observation, self.config.avoidance.horizon + 1.0)
        if observation["leader"][5] > 0.5:
            points = without(points, np.array([[goal.x, goal.y]]), self.config.body)
        if goal.mode is Mode.SEARCH:
            self._trail.clear()
            return self._command(0.0, self._memory.look_around(lambda turn: self._kept_turn(turn, points)))
        self._trail.extend(goal.x, goal.y)
        aim = self._trail.aim(self.config.lookahead) or (goal.x, goal.y)
        bearing, reach = math.atan2(aim[1], aim[0]), math.hypot(*aim)
        way = free_heading(bearing, reach, points, self._deviation, self.config.avoidance, self.interface)
        self._deviation = way.heading - bearing
        return self._command(*self._drive(goal, way, reach, points))

    def _drive(self, goal: Goal, way: FreeHeading, reach: float, points: Array) -> tuple[float, float]:
        c, heading, ahead = self.config, way.heading, way.ahead
        keep = c.distance if goal.mode is Mode.FOLLOW else 0.0
        pace = max(0.0, goal.vx * math.cos(goal.bearing) + goal.vy * math.sin(goal.bearing))
        wish = pace + c.catch_up * (goal.distance - keep)
        if abs(heading) > c.pivot:
            turn = c.pivot_gain * heading
            kept = self._kept_turn(turn, points)  # who cannot turn here goes on until it can
            return (1.0 - kept / turn) * min(max(0.0, wish), self.interface.max_speed, self._safe_speed(ahead)), kept
        if wish < -0.1:
            back = min(c.reverse_speed, self._safe_speed(self._behind.room()))
            return max(wish, -back), self._kept_turn(c.pivot_gain * goal.bearing, points)
        speed = max(0.0, wish) * math.cos(heading)
        speed = min(speed, self.interface.max_speed, self._safe_speed(ahead))
        curvature = 2.0 * math.sin(heading) / max(reach, 0.3)
        standing_turn = 0.0 if speed > 0.15 else c.pivot_gain * goal.bearing
        return speed, self._kept_turn(speed * curvature + standing_turn, points)

    def _kept_turn(self, wish: float, points: Array) -> float:
        """Return the turn rate nearest to `wish` that ends before a corner meets one of `points` (n, 2) [rad/s]."""
        c = self.config
        return kept_turn(wish, points, c.turn_acceleration, c.reaction_s, c.avoidance, self.interface)

    def _safe_speed(self, room: float) -> float:
        """Return the speed from which the robot stops a decimetre before the end of `room` [m/s]."""
        return math.sqrt(2.0 * self.config.acceleration * max(0.0, room - 0.1))

    def _command(self, speed: float, turn: float) -> NDArray[np.float32]:
        step, turn_step = self.config.acceleration * self._step_s, self.config.turn_acceleration * self._step_s
        top = self.interface.max_turn_rate
        self._speed = min(max(speed, self._speed - step), self._speed + step)
        self._turn = min(max(turn, self._turn - turn_step, -top), self._turn + turn_step, top)
        return as_action(self._speed, self._turn, self.interface)
