"""Wheel odometry with a systematic error, drawn once per drive, and random errors.

Random errors are scaled with the square root of the way and of the turn, so that they do not depend on the rate of
updates; their four numbers play the part of alpha1-4 of Thrun, Burgard, Fox 2005, section 5.4.
"""

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...slam.bounds import Within, check_numbers
from ...slam.errors import unknown_name

Array = NDArray[np.float64]
_Error = Annotated[float, Within(0.0, 10.0)]  # ten times what was driven


@dataclass(frozen=True, kw_only=True)
class OdometryConfig:
    """Errors of the wheel odometry.

    Attributes:
        scale_limit: Systematic error of distances, drawn from +- this [share].
        turn_limit: Systematic error of turns, drawn from +- this [share].
        drift_limit: Systematic turn per way, drawn from +- this [rad/m] (wheels of unequal size).
        alpha1: Random turn per square root of turn [rad/sqrt(rad)].
        alpha2: Random turn per square root of way [rad/sqrt(m)].
        alpha3: Random way per square root of way [m/sqrt(m)].
        alpha4: Random way per square root of turn [m/sqrt(rad)].
    """

    scale_limit: _Error
    turn_limit: _Error
    drift_limit: _Error
    alpha1: _Error
    alpha2: _Error
    alpha3: _Error
    alpha4: _Error

    def __post_init__(self) -> None:
        check_numbers(self)


QUALITIES: dict[str, OdometryConfig] = {
    "perfect": OdometryConfig(
        scale_limit=0.0, turn_limit=0.0, drift_limit=0.0, alpha1=0.0, alpha2=0.0, alpha3=0.0, alpha4=0.0
    ),
    "good": OdometryConfig(
        scale_limit=0.005,
        turn_limit=0.005,
        drift_limit=np.radians(0.03),
        alpha1=np.radians(0.3),
        alpha2=np.radians(0.1),
        alpha3=0.003,
        alpha4=0.001,
    ),
    "typical": OdometryConfig(
        scale_limit=0.02,
        turn_limit=0.02,
        drift_limit=np.radians(0.15),
        alpha1=np.radians(0.8),
        alpha2=np.radians(0.3),
        alpha3=0.01,
        alpha4=0.004,
    ),
    "slipping": OdometryConfig(
        scale_limit=0.10,
        turn_limit=0.08,
        drift_limit=np.radians(0.5),
        alpha1=np.radians(2.0),
        alpha2=np.radians(0.8),
        alpha3=0.03,
        alpha4=0.01,
    ),
}
"""Named qualities. After 10 m straight: good within 5 cm and 0.3 deg of systematic error, typical within 20 cm and
1.5 deg, slipping within 1 m and 5 deg; after a full turn: 2, 7 and 29 deg."""


def odometry_quality(name: str) -> OdometryConfig:
    """Return the quality called `name`.

    Raises:
        InputError: If there is none.
    """
    if name not in QUALITIES:
        raise unknown_name("odometry quality", name, tuple(QUALITIES))
    return QUALITIES[name]


class WheelOdometry:
    """Adds up what the wheels believe.

    Args:
        config: The errors.
        rng: Source of the systematic error now, and of the random ones later.
        start: (3,) T_world_robot at the start; the odometry frame is the robot's frame there.
    """

    def __init__(self, config: OdometryConfig, rng: np.random.Generator, start: Array) -> None:
        self.config = config
        limits = np.array([config.scale_limit, config.turn_limit, config.drift_limit])
        self.scale, self.turn_scale, self.drift = (rng.uniform(-1.0, 1.0, 3) * limits).tolist()
        self.pose = np.zeros(3)
        self.last_true = np.array(start, dtype=np.float64)
        self._rng = rng

    def update(self, T_world_robot: ArrayLike) -> Array:
        """Take the robot's true pose (3,) after a short motion, or those (k, 3) after k of them; return T_odom_robot
        (3,).
        """
        poses = np.atleast_2d(np.asarray(T_world_robot, dtype=np.float64)).tolist()
        x0, y0, theta0 = self.last_true.tolist()
        believed = tuple(self.pose.tolist())
        for (x1, y1, theta1), noise in zip(poses, self._rng.standard_normal((len(poses), 3)).tolist(), strict=True):
            cos, sin = math.cos(theta0), math.sin(theta0)
            x, y = cos * (x1 - x0) + sin * (y1 - y0), cos * (y1 - y0) - sin * (x1 - x0)
            turn = math.remainder(theta1 - theta0, math.tau)
            believed = _moved(*believed, *self._believed(x, y, turn, noise))
            x0, y0, theta0 = x1, y1, theta1
        self.last_true, self.pose = np.array((x0, y0, theta0)), np.array(believed)
        return self.pose

    def _believed(self, x: float, y: float, turn: float, noise: list[float]) -> tuple[float, float, float]:
        """Return the motion in the robot's frame that the wheels report for a true one [m, m, rad]."""
        config = self.config
        way, spin = math.hypot(x, y), abs(turn)
        sigma_way = math.sqrt(config.alpha3**2 * way + config.alpha4**2 * spin)
        sigma_turn = math.sqrt(config.alpha1**2 * spin + config.alpha2**2 * way)
        stretch = 1.0 + self.scale + (sigma_way * noise[0] / way if way > 1e-9 else 0.0)
        sideways = 0.25 * sigma_way * noise[1]
        drift = self.drift * math.copysign(way, x)
        return stretch * x, stretch * y + sideways, (1.0 + self.turn_scale) * turn + drift + sigma_turn * noise[2]


def _moved(x0: float, y0: float, theta: float, x: float, y: float, turn: float) -> tuple[float, float, float]:
    """Return the pose that is (x, y, turn) further, seen from (x0, y0, theta)."""
    cos, sin = math.cos(theta), math.sin(theta)
    return x0 + cos * x - sin * y, y0 + sin * x + cos * y, (theta + turn + math.pi) % math.tau - math.pi
