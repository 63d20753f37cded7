"""A model of an operator with a joystick. It is a model and is labelled so; nothing here was measured on a person.

The operator stands in the building, sees the robot and the people, knows the way, and steers for a point ahead on it:
with a delay of reaction, holding the stick for a while before correcting, in steps of the stick, with too much
correction, with errors that grow with the movement, and with a thumb that moves only so fast. How fast the thumb moves
and how much too much is given are fitted to real robots under a joystick (`tagalong teleop --calibrate`;
velocities over 0.4 s, RMS while moving):

| drive | 95 % of speed [m/s] | 99 % of turn rate [rad/s] | acceleration [m/s^2] | turn acceleration [rad/s^2] |
|---|---|---|---|---|
| Intel (real) | 0.66 | 1.09 | 0.80 | 0.69 |
| ACES (real) | 0.73 | 0.96 | 0.32 | 0.52 |
| model | 0.75 | 1.00 | 0.37 | 0.56 |
"""

from collections import deque
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...slam.errors import InputError
from ...slam.geometry import transform_points, wrap_angle

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class OperatorConfig:
    """How the operator drives.

    Attributes:
        full_speed: Speed at full stick [m/s]; about the 95 % quantile of the logs.
        full_turn: Turn rate at full stick [rad/s]; about the 99 % quantile of the logs.
        reaction_s: From seeing to moving the stick [s].
        hold_s: Mean time that the stick is held before the next correction [s].
        levels: Positions of the stick to each side of its middle.
        lookahead: Distance along the way of the point steered for [m].
        gain: Turn rate wanted per heading error [1/s].
        over_correction: How much more is given than is wanted.
        error: Standard deviation of the stick's position, relative to the movement.
        slew: How fast the stick moves [full sticks/s].
        stop_m: Stops when somebody is nearer than this in front, centre to centre [m].
        slow_m: Drives at half speed when somebody is nearer than this in front [m].
        stuck_s: Backs out when the robot has not moved for this long though the stick is forward [s].
        back_s: For how long it is backed out, at half stick [s].
    """

    full_speed: float = 0.75
    full_turn: float = 1.0
    reaction_s: float = 0.3
    hold_s: float = 0.5
    levels: int = 4
    lookahead: float = 1.2
    gain: float = 1.2
    over_correction: float = 0.6
    error: float = 0.15
    slew: float = 0.8
    stop_m: float = 1.0
    slow_m: float = 1.8
    stuck_s: float = 2.0
    back_s: float = 2.0

    def __post_init__(self) -> None:
        for name in ("full_speed", "full_turn", "hold_s", "levels", "lookahead", "slew"):
            if not getattr(self, name) > 0:
                raise InputError(f"`{name}` of the operator must be positive, got {getattr(self, name)}")


@dataclass(frozen=True, eq=False)
class OperatorView:
    """What the operator sees: the truth, with their own eyes.

    Attributes:
        pose: (3,) of the robot, world frame.
        progress: Way of the robot along the route [m].
        people: (n, 2) places of people [m].
    """

    pose: Array
    progress: float
    people: Array


class OperatorModel:
    """Holds the stick.

    Args:
        route: (n, 2) the way to drive, world frame [m].
        rng: Source of all draws.
        config: How to drive.
        step_s: Time between two calls of `act` [s].
    """

    def __init__(
        self, route: Array, rng: np.random.Generator, config: OperatorConfig | None = None, step_s: float = 0.1
    ) -> None:
        self.config = config or OperatorConfig()
        self._arcs = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(route, axis=0).T))))
        self._route, self._rng, self._step_s = route, rng, step_s
        self._seen: deque[OperatorView] = deque(maxlen=round(self.config.reaction_s / step_s) + 1)
        self._stick, self._aim, self._hold_s = np.zeros(2), np.zeros(2), 0.0
        self._still_s = self._back_s = 0.0
        self._last = np.full(2, np.inf)

    def act(self, sight: OperatorView) -> Array:
        """Return (2,) forward speed [m/s] and turn rate [rad/s] that the stick asks for now."""
        self._seen.append(sight)
        self._notice(self._seen[0])
        self._hold_s -= self._step_s
        if self._hold_s <= 0.0:
            self._aim = self._decide(self._seen[0])
            self._hold_s = self.config.hold_s * float(self._rng.uniform(0.5, 1.5))
        reach = self.config.slew * self._step_s
        self._stick = self._stick + np.clip(self._aim - self._stick, -reach, reach)
        levels = self.config.levels
        stick = np.round(self._stick * levels) / levels
        return stick * (self.config.full_speed, self.config.full_turn)

    def _decide(self, sight: OperatorView) -> Array:
        """Return (2,) where the stick shall go, each in [-1, 1]."""
        c = self.config
        if self._back_s > 0.0:
            return np.array((-0.5, 0.0))
        ahead = sight.progress + c.lookahead
        target = np.array([np.interp(ahead, self._arcs, axis) for axis in self._route.T])
        error = float(wrap_angle(np.arctan2(*(target - sight.pose[:2])[::-1]) - sight.pose[2]))
        turn = (1.0 + c.over_correction) * c.gain * error / c.full_turn
        forward = max(0.0, np.cos(error)) ** 2 * self._care(sight)
        wanted = np.array((forward, turn))
        return np.clip(wanted * (1.0 + self._rng.normal(0.0, c.error, 2)), -1.0, 1.0)

    def _notice(self, sight: OperatorView) -> None:
        """Count for how long the robot has stood though the stick is forward."""
        stands = float(np.hypot(*(sight.pose[:2] - self._last))) < 0.05 * self._step_s
        self._last = sight.pose[:2].copy()
        self._still_s = self._still_s + self._step_s if stands and self._stick[0] > 0.2 else 0.0
        self._back_s = max(0.0, self._back_s - self._step_s)
        if self._still_s > self.config.stuck_s:
            self._still_s, self._back_s = 0.0, self.config.back_s

    def _care(self, sight: OperatorView) -> float:
        """Return how much of the speed people in front allow."""
        x, y, theta = sight.pose
        local = transform_points((0.0, 0.0, -theta), sight.people - (x, y)) if len(sight.people) else np.empty((0, 2))
        front = local[(local[:, 0] > 0.0) & (np.abs(local[:, 1]) < 0.7)]
        nearest = float(np.hypot(*front.T).min(initial=np.inf))
        return 0.0 if nearest < self.config.stop_m else 0.5 if nearest < self.config.slow_m else 1.0
