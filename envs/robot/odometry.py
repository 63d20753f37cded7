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
from ...slam.view_kernel import kernel

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
        random = (config.alpha1, config.alpha2, config.alpha3, config.alpha4)
        self._errors = np.array([*(rng.uniform(-1.0, 1.0, 3) * limits).tolist(), *random])
        self.pose = np.zeros(3)
        self.last_true = np.array(start, dtype=np.float64)
        self._rng = rng

    @property
    def errors(self) -> Array:
        """(7,) the errors of this drive, as `believed_motion` takes them."""
        return self._errors.copy()

    def update(self, T_world_robot: ArrayLike) -> Array:
        """Take the robot's true pose (3,) after a short motion, or those (k, 3) after k of them; return T_odom_robot
        (3,).
        """
        poses = np.atleast_2d(np.asarray(T_world_robot, dtype=np.float64))
        noise = self._rng.standard_normal((len(poses), 3))
        self.pose = np.array(believed_motion(self.pose, self.last_true, poses, self._errors, noise))
        self.last_true = poses[-1].copy()
        return self.pose


@kernel
def believed_motion(
    believed: Array, last: Array, poses: Array, errors: Array, noise: Array
) -> tuple[float, float, float]:
    """Return the pose that the wheels believe in after short motions.

    Args:
        believed: (3,) what they believed before.
        last: (3,) the true pose before.
        poses: (k, 3) the true poses after each motion.
        errors: (7,) systematic errors of distance, of turns [share] and of turns by way [rad/m], then `alpha1` to
            `alpha4` of `OdometryConfig`.
        noise: (k, 3) standard normal draws.
    """
    bx, by, b_theta = believed
    x0, y0, theta0 = last
    for k in range(len(poses)):
        cos, sin = math.cos(theta0), math.sin(theta0)
        x = cos * (poses[k, 0] - x0) + sin * (poses[k, 1] - y0)
        y = cos * (poses[k, 1] - y0) - sin * (poses[k, 0] - x0)
        turn = (poses[k, 2] - theta0 + np.pi) % (2.0 * np.pi) - np.pi
        way, spin = math.sqrt(x * x + y * y), abs(turn)
        sigma_way = math.sqrt(errors[5] ** 2 * way + errors[6] ** 2 * spin)
        sigma_turn = math.sqrt(errors[3] ** 2 * spin + errors[4] ** 2 * way)
        stretch = 1.0 + errors[0] + (sigma_way * noise[k, 0] / way if way > 1e-9 else 0.0)
        ahead, aside = stretch * x, stretch * y + 0.25 * sigma_way * noise[k, 1]
        turned = (1.0 + errors[1]) * turn + errors[2] * math.copysign(way, x) + sigma_turn * noise[k, 2]
        cos, sin = math.cos(b_theta), math.sin(b_theta)
        bx, by = bx + cos * ahead - sin * aside, by + sin * ahead + cos * aside
        b_theta = (b_theta + turned + np.pi) % (2.0 * np.pi) - np.pi
        x0, y0, theta0 = poses[k, 0], poses[k, 1], poses[k, 2]
    return bx, by, b_theta
