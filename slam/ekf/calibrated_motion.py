"""Odometry with unknown systematic errors: they are states of the filter, not noise.

A systematic error put into Q as white noise makes the filter sure of itself where it is wrong in the same way at each
step; estimated beside the pose, it is right, and landmarks teach it. The wheels report (u', v', w') of a true motion
(u, v, w): u' = (1 + a) u, v' = (1 + a) v, w' = (1 + b) w + c |(u, v)| sign(u), plus noise.
State: (x, y, theta, a, b, c): pose, scale of ways, scale of turns, turn per way [rad/m].
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..bounds import Share, check_numbers
from ..errors import InputError

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class OdometryNoise:
    """What is known of the wheels. The defaults fit wheels as usual: 2 % of way and turn, 0.15 deg/m of drift.

    Attributes:
        sigma_scale: Standard deviation of the systematic error of ways [share].
        sigma_turn: Of turns [share].
        sigma_drift: Of the systematic turn per way [rad/m].
        alpha1: Random turn per square root of turn [rad/sqrt(rad)].
        alpha2: Random turn per square root of way [rad/sqrt(m)].
        alpha3: Random way per square root of way [m/sqrt(m)].
        alpha4: Random way per square root of turn [m/sqrt(rad)].
        sideways: Random sideways motion as a share of the random way.
    """

    sigma_scale: Share = 0.02 / math.sqrt(3.0)
    sigma_turn: Share = 0.02 / math.sqrt(3.0)
    sigma_drift: float = math.radians(0.15) / math.sqrt(3.0)
    alpha1: float = math.radians(0.8)
    alpha2: float = math.radians(0.3)
    alpha3: float = 0.01
    alpha4: float = 0.004
    sideways: float = 0.25

    def __post_init__(self) -> None:
        check_numbers(self)
        for name, value in vars(self).items():
            if not value >= 0.0:
                raise InputError(f"`{name}` must not be negative, got {value}")


def advance(state: Array, reported: Array) -> Array:
    """Return the state (6,) after the wheels reported a motion (3,) in the robot's frame; theta is not wrapped."""
    x, y, theta, a, b, c = state.tolist()
    u, v, turn = _corrected(reported, a, b, c)
    cos, sin = math.cos(theta), math.sin(theta)
    return np.array([x + cos * u - sin * v, y + sin * u + cos * v, theta + turn, a, b, c])


def advance_jacobian(state: Array, reported: Array) -> Array:
    """Return F (3, 6), the derivative of the pose part of `advance` by the state."""
    _, _, theta, a, b, c = state.tolist()
    u, v, turn = _corrected(reported, a, b, c)
    cos, sin = math.cos(theta), math.sin(theta)
    dx, dy = cos * u - sin * v, sin * u + cos * v
    way = math.copysign(math.hypot(u, v), u)
    F = np.zeros((3, 6))
    F[:, :3] = [[1.0, 0.0, -dy], [0.0, 1.0, dx], [0.0, 0.0, 1.0]]
    F[:, 3] = [-dx / (1.0 + a), -dy / (1.0 + a), c * way / (1.0 + a) / (1.0 + b)]
    F[2, 4], F[2, 5] = -turn / (1.0 + b), -way / (1.0 + b)
    return F


def process_noise(state: Array, reported: Array, noise: OdometryNoise) -> Array:
    """Return Q (3, 3) of the pose for one reported motion (3,); a floor keeps it positive definite."""
    way, spin = math.hypot(reported[0], reported[1]), abs(float(reported[2]))
    way_variance = noise.alpha3**2 * way + noise.alpha4**2 * spin
    turn_variance = noise.alpha1**2 * spin + noise.alpha2**2 * way
    cos, sin = math.cos(state[2]), math.sin(state[2])
    turned = np.array([[cos, -sin], [sin, cos]])
    Q = np.zeros((3, 3))
    Q[:2, :2] = turned @ np.diag([way_variance, noise.sideways**2 * way_variance]) @ turned.T
    Q[2, 2] = turn_variance
    return Q + 1e-12 * np.eye(3)


def _corrected(reported: Array, a: float, b: float, c: float) -> tuple[float, float, float]:
    u, v = float(reported[0]) / (1.0 + a), float(reported[1]) / (1.0 + a)
    return u, v, (float(reported[2]) - c * math.copysign(math.hypot(u, v), u)) / (1.0 + b)
