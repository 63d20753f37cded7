"""The dynamic window approach (Fox, Burgard, Thrun 1997): the best of the velocities that can be reached and stopped.

Added to the original: people are predicted at constant velocity and keep a personal space of their own.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...envs.task.interface import FollowInterface
from ...slam.errors import InputError
from .footprint_kernel import box_gaps

Array = NDArray[np.float64]
_ELSEWHERE_M = 0.4  # a target farther than this is elsewhere


@dataclass(frozen=True, kw_only=True)
class DynamicWindowConfig:
    """Limits, sizes and weights.

    Attributes:
        max_speed: Fastest forwards [m/s].
        reverse_speed: Fastest backwards [m/s].
        max_turn_rate: Fastest turn [rad/s].
        acceleration: Change of speed used [m/s^2]; below the robot's limit of 2.
        turn_acceleration: Change of turn rate used [rad/s^2]; below the robot's limit of 8.
        window_s: Velocities that can be reached within this time are compared [s].
        speeds: How many speeds are compared.
        turns: How many turn rates, odd.
        horizon_s: How far ahead a velocity is followed [s].
        steps: In how many steps.
        margin: Nothing may come nearer to the robot's edge than this: the laser is off by centimetres, and so is a
            stop [m].
        comfort: Things farther than this from its edge cost nothing [m].
        space: People farther than this, surface to surface, cost nothing [m]: personal space and a margin.
        person_radius: Radius taken for people [m].
        goal: Weight of the distance to the target at the end, in horizons driven at full speed.
        facing: Weight of the direction to the target at the end, over pi.
        clearance: Weight of the lack of `comfort`.
        social: Weight of the lack of `space`.
        patience_s: The weights of clearance and people are halved when it has stood for this long though the target is
            elsewhere, and so on: who stands beside the only way is passed in the end [s].
        effort: Weight of the change of speed and turn rate, over the window.
    """

    max_speed: float = 1.2
    reverse_speed: float = 0.3
    max_turn_rate: float = 1.6
    acceleration: float = 1.2
    turn_acceleration: float = 3.0
    window_s: float = 0.3
    speeds: int = 7
    turns: int = 15
    horizon_s: float = 1.6
    steps: int = 8
    margin: float = 0.04
    comfort: float = 0.15
    space: float = 0.55
    person_radius: float = 0.25
    goal: float = 1.3
    facing: float = 0.5
    clearance: float = 0.8
    social: float = 0.7
    patience_s: float = 4.0
    effort: float = 0.05

    def __post_init__(self) -> None:
        for name in ("max_speed", "max_turn_rate", "acceleration", "turn_acceleration", "horizon_s"):
            if not getattr(self, name) > 0.0:
                raise InputError(f"`{name}` of the dynamic window must be positive, got {getattr(self, name)}")

    def within(self, interface: FollowInterface) -> "DynamicWindowConfig":
        """Return the same with no speed beyond what actions can ask for."""
        fastest, turn = min(self.max_speed, interface.max_speed), min(self.max_turn_rate, interface.max_turn_rate)
        return replace(self, max_speed=fastest, max_turn_rate=turn)


@dataclass(frozen=True, eq=False)
class Obstacles:
    """What the robot must mind; robot frame.

    Attributes:
        obstacles: (n, 2) points that must not be touched [m].
        people: (k, 4) x, y [m], vx, vy over ground [m/s] of people, who want some more space than that.
    """

    obstacles: Array
    people: Array


class DynamicWindow:
    """Chooses a velocity; remembers only what it commanded last."""

    def __init__(self, config: DynamicWindowConfig, robot: FollowInterface) -> None:
        self.config, self._step_s = config.within(robot), 1.0 / robot.control_hz
        self._robot = robot
        self._times = np.linspace(0.0, config.horizon_s, config.steps + 1)[1:]
        self.reset()

    def reset(self) -> None:
        """Stand still."""
        self._speed = self._turn = self._stood_s = 0.0

    def choose(self, target: Array, look_at: Array, around: Obstacles) -> tuple[float, float]:
        """Return speed [m/s] and turn rate [rad/s] to command now.

        Args:
            target: (2,) where to be, robot frame [m].
            look_at: (2,) what to face in the end [m].
            around: What to mind.
        """
        stands = abs(self._speed) < 0.05 and float(np.hypot(target[0], target[1])) > _ELSEWHERE_M
        self._stood_s = self._stood_s + self._step_s if stands else 0.5 * self._stood_s
        speeds, turns = self._window()
        paths = arcs(speeds, turns, self._times)
        gap = self._gaps(paths, around.obstacles)
        cost = self._costs(speeds, turns, paths, gap, target, look_at, around.people)
        cost[~self._can_stop(speeds, gap, around.obstacles)] = np.inf
        best = int(np.argmin(cost))
        if np.isinf(cost[best]):
            return self._approach(0.0, 0.0)
        return self._approach(float(speeds[best]), float(turns[best]))

    def turn(self, rate: float, around: Obstacles) -> tuple[float, float]:
        """Return speed [m/s] and turn rate [rad/s] to turn on the spot; it stands where it would touch something."""
        gap = self._gaps(arcs(np.zeros(1), np.array([rate]), self._times), around.obstacles)
        free = bool(self._can_stop(np.zeros(1), gap, around.obstacles)[0])
        return self._approach(0.0, rate if free else 0.0)

    def _window(self) -> tuple[Array, Array]:
        """Return (c,) speeds and (c,) turn rates that can be reached."""
        c = self.config
        reach, turn_reach = c.acceleration * c.window_s, c.turn_acceleration * c.window_s
        speed = np.linspace(max(self._speed - reach, -c.reverse_speed), min(self._speed + reach, c.max_speed), c.speeds)
        turn = np.linspace(
            max(self._turn - turn_reach, -c.max_turn_rate), min(self._turn + turn_reach, c.max_turn_rate), c.turns
        )
        speed = np.append(speed, 0.0) if speed[0] < 0.0 < speed[-1] else speed
        turn = np.append(turn, 0.0) if turn[0] < 0.0 < turn[-1] else turn
        grid = np.meshgrid(speed, turn, indexing="ij")
        return grid[0].ravel(), grid[1].ravel()

    def _gaps(self, poses: Array, obstacles: Array) -> Array:
        """Return (c, t) distance from the robot's edge at each pose (c, t, 3) to the nearest obstacle (n, 2) [m]."""
        half_length, half_width = self._robot.half_length, self._robot.half_width
        return box_gaps(poses, np.ascontiguousarray(obstacles), half_length, half_width, self.config.comfort)

    def _can_stop(self, speeds: Array, gap: Array, obstacles: Array) -> NDArray[np.bool_]:
        """Return (c,) whether the robot can stop before it meets anything; what is too near already may not be nearer.

        Args:
            speeds: (c,) [m/s].
            gap: (c, t) distances to the nearest obstacle [m].
            obstacles: (n, 2) [m].
        """
        c = self.config
        now = float(self._gaps(np.zeros((1, 1, 3)), obstacles)[0, 0])
        meets = gap < min(c.margin, now - 0.01)
        if now < c.margin:
            return np.logical_not(meets.any(axis=1))
        first = np.where(meets.any(axis=1), np.argmax(meets, axis=1), len(self._times))
        driven = np.append(self._times, c.horizon_s)[first] - self._times[0]
        return (first == len(self._times)) | (np.abs(speeds) * driven > speeds**2 / (2.0 * c.acceleration))

    def _costs(
        self, speeds: Array, turns: Array, paths: Array, gap: Array, target: Array, look_at: Array, people: Array
    ) -> Array:
        """Return (c,) cost of each velocity."""
        c, end = self.config, paths[:, -1]
        distance = np.hypot(target[0] - end[:, 0], target[1] - end[:, 1]) / (c.max_speed * c.horizon_s)
        bearing = np.arctan2(look_at[1] - end[:, 1], look_at[0] - end[:, 0]) - end[:, 2]
        facing = np.abs((bearing + np.pi) % (2.0 * np.pi) - np.pi) / np.pi
        tight = 1.0 - np.clip(gap.min(axis=1) / c.comfort, 0.0, 1.0)
        change = np.abs(speeds - self._speed) / (c.acceleration * c.window_s)
        turn_change = np.abs(turns - self._turn) / (c.turn_acceleration * c.window_s)
        caution = 1.0 / (1.0 + self._stood_s / c.patience_s)
        return (
            c.goal * distance
            + c.facing * facing
            + caution * c.clearance * tight
            + caution * c.social * self._intrusion(paths[:, :, :2], people)
            + c.effort * (change + turn_change)
        )

    def _intrusion(self, places: Array, people: Array) -> Array:
        """Return (c,) the deepest lack of space to anybody along each path, 0 .. 1 and beyond where bodies overlap."""
        if not len(people):
            return np.zeros(len(places))
        c = self.config
        where = people[None, :, :2] + self._times[:, None, None] * people[None, :, 2:4]
        radii = self._robot.turning_radius + c.person_radius
        gap = np.hypot(*(places[:, :, None] - where[None]).transpose(3, 0, 1, 2)) - radii
        lack = np.maximum(1.0 - gap / c.space, 0.0)
        later = 1.0 - 0.5 * self._times / c.horizon_s
        return (lack * later[None, :, None]).max(axis=(1, 2))

    def _approach(self, speed: float, turn: float) -> tuple[float, float]:
        """Return the command, moved towards a velocity no faster than allowed; braking may be harder."""
        c = self.config
        more, less, most = c.acceleration * self._step_s, 1.5 * c.acceleration * self._step_s, c.turn_acceleration
        self._speed = min(max(speed, self._speed - less), self._speed + more)
        self._turn = min(max(turn, self._turn - most * self._step_s), self._turn + most * self._step_s)
        return self._speed, self._turn


def arcs(speeds: Array, turns: Array, times: Array) -> Array:
    """Return (c, t, 3) poses after `times` (t,) [s] at constant `speeds` and `turns` (c,), from the origin."""
    angle = turns[:, None] * times
    # sin(a)/a and (1 - cos(a))/a by their series' first terms where a vanishes
    small = np.abs(angle) < 1e-6
    safe = np.where(small, 1.0, angle)
    along = np.where(small, 1.0, np.sin(safe) / safe)
    aside = np.where(small, angle / 2.0, (1.0 - np.cos(safe)) / safe)
    way = speeds[:, None] * times
    return np.stack((way * along, way * aside, angle), axis=-1)
