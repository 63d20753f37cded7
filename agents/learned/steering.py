"""Smooth driving: from a wanted velocity to commands whose acceleration and jerk are limited.

The policy says which velocity it wants; how fast the robot may get there is not the policy's choice. So motion is
smooth from the first random drive on, and no reward has to teach it.
"""

from dataclasses import astuple, dataclass

import numpy as np
from numpy.typing import NDArray

from ...slam.errors import InputError

Array = NDArray[np.float64]

State = tuple[float, float, float, float]
"""Commanded forward speed, its rate, commanded turn rate, its rate [m/s, m/s^2, rad/s, rad/s^2]."""
REST: State = (0.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True, kw_only=True)
class SteeringConfig:
    """Range of the wish, and limits on the way to it.

    Attributes:
        max_speed: Fastest forwards, wished by +1 [m/s].
        reverse_speed: Fastest backwards, wished by -1 [m/s].
        max_turn_rate: Fastest turn [rad/s].
        settle_s: Time constant with which the speed settles [s].
        turn_settle_s: The same of the turn rate [s].
        acceleration: Largest change of speed [m/s^2].
        braking: Largest change of speed towards zero [m/s^2]; the robot's own limit is 2.
        turn_acceleration: Largest change of the turn rate [rad/s^2].
        jerk: Largest change of the acceleration [m/s^3].
        brake_jerk: The same towards braking [m/s^3].
        turn_jerk: The same of the turn [rad/s^3].
        wish_s: Time constant with which what the network wishes is smoothed first; 0: not at all [s].
    """

    max_speed: float = 1.3
    reverse_speed: float = 0.4
    max_turn_rate: float = 1.6
    settle_s: float = 0.35
    turn_settle_s: float = 0.25
    acceleration: float = 1.2
    braking: float = 1.8
    turn_acceleration: float = 3.0
    jerk: float = 4.0
    brake_jerk: float = 8.0
    turn_jerk: float = 16.0
    wish_s: float = 0.1

    def __post_init__(self) -> None:
        for name, value in self.__dict__.items():
            if not (value > 0.0 or (name == "wish_s" and value == 0.0)):
                raise InputError(f"`{name}` of the steering must be positive, got {value}")

    def as_tuple(self) -> tuple[float, ...]:
        """Return the fields in their order, as the kernel of the teacher takes them."""
        return astuple(self)

    def wish(self, output: tuple[float, float]) -> tuple[float, float]:
        """Return the velocity [m/s, rad/s] wished by two numbers in [-1, 1]; numbers beyond are cut."""
        forward, turn = (min(max(float(value), -1.0), 1.0) for value in output)
        middle, half = 0.5 * (self.max_speed - self.reverse_speed), 0.5 * (self.max_speed + self.reverse_speed)
        return middle + half * forward, self.max_turn_rate * turn

    def clipped(self, speed: float, turn: float) -> tuple[float, float]:
        """Return the velocity that can be wished next to `speed` [m/s] and `turn` [rad/s]."""
        return (
            min(max(speed, -self.reverse_speed), self.max_speed),
            min(max(turn, -self.max_turn_rate), self.max_turn_rate),
        )

    def output(self, speed: float, turn: float) -> tuple[float, float]:
        """Return the two numbers that wish `speed` [m/s] and `turn` [rad/s]: the inverse of `wish`."""
        middle, half = 0.5 * (self.max_speed - self.reverse_speed), 0.5 * (self.max_speed + self.reverse_speed)
        return (speed - middle) / half, turn / self.max_turn_rate


def steer(state: State, speed: float, turn: float, step_s: float, c: SteeringConfig) -> State:
    """Return the commands one step of `step_s` [s] after `state`, on the way to `speed` [m/s] and `turn` [rad/s]."""
    v, a, w, b = state
    brakes = (speed - v) * v < 0.0
    most = c.braking if brakes else c.acceleration
    change = (c.brake_jerk if brakes else c.jerk) * step_s
    wanted = min(max((speed - v) / c.settle_s, -most), most)
    a = min(max(wanted, a - change), a + change)
    turning = min(max((turn - w) / c.turn_settle_s, -c.turn_acceleration), c.turn_acceleration)
    b = min(max(turning, b - c.turn_jerk * step_s), b + c.turn_jerk * step_s)
    v = min(max(v + a * step_s, -c.reverse_speed), c.max_speed)
    w = min(max(w + b * step_s, -c.max_turn_rate), c.max_turn_rate)
    return v, a, w, b


def steer_many(states: Array, wishes: Array, step_s: float, c: SteeringConfig) -> Array:
    """Do as `steer` does for many at once: `states` (n, 4), `wishes` (n, 2) speed and turn rate; return (n, 4)."""
    v, a, w, b = states.T
    brakes = (wishes[:, 0] - v) * v < 0.0
    most = np.where(brakes, c.braking, c.acceleration)
    change = np.where(brakes, c.brake_jerk, c.jerk) * step_s
    a = np.clip(np.clip((wishes[:, 0] - v) / c.settle_s, -most, most), a - change, a + change)
    turning = np.clip((wishes[:, 1] - w) / c.turn_settle_s, -c.turn_acceleration, c.turn_acceleration)
    b = np.clip(turning, b - c.turn_jerk * step_s, b + c.turn_jerk * step_s)
    v = np.clip(v + a * step_s, -c.reverse_speed, c.max_speed)
    w = np.clip(w + b * step_s, -c.max_turn_rate, c.max_turn_rate)
    return np.stack((v, a, w, b), axis=1)
