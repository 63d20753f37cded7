"""Where the robot must be by its odometry, and how far that is to be trusted."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..bounds import check_numbers
from ..errors import InputError
from ..geometry import between, compose

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class ExtrapolatorConfig:
    """Error model of the odometry: standard deviations of a motion of d metres and a radians.

    Attributes:
        translation_floor: Of the translation, always [m].
        translation_per_metre: Of the translation, more for each metre [m/m].
        translation_per_radian: Of the translation, more for each radian [m/rad].
        rotation_floor: Of the rotation, always [rad].
        rotation_per_metre: Of the rotation, more for each metre [rad/m].
        rotation_per_radian: Of the rotation, more for each radian [rad/rad].
    """

    translation_floor: float = 0.03
    translation_per_metre: float = 0.06
    translation_per_radian: float = 0.05
    rotation_floor: float = 0.005
    rotation_per_metre: float = 0.075
    rotation_per_radian: float = 0.15

    def __post_init__(self) -> None:
        check_numbers(self)
        for name, value in vars(self).items():
            if not value >= 0.0 or (name.endswith("floor") and value == 0.0):
                rule = "be positive" if name.endswith("floor") else "not be negative"
                raise InputError(f"`{name}` must {rule}, got {value}")

    def sigma(self, motion: Array) -> Array:
        """Return (2,) standard deviations of translation [m] and rotation [rad] of a `motion` (3,) of the odometry."""
        x, y, turn = motion.tolist()
        metres, radians = math.hypot(x, y), abs(turn)
        translation = (
            self.translation_floor + self.translation_per_metre * metres + self.translation_per_radian * radians
        )
        rotation = self.rotation_floor + self.rotation_per_metre * metres + self.rotation_per_radian * radians
        return np.array([translation, rotation])


@dataclass(frozen=True, eq=False)
class Prediction:
    """A pose by odometry.

    Attributes:
        pose: (3,) T_local_robot [m, m, rad].
        sigma: (2,) standard deviations of its translation [m] and rotation [rad].
    """

    pose: Array
    sigma: Array

    @property
    def information(self) -> Array:
        """(3, 3) inverse covariance, the same in both directions of translation."""
        translation, rotation = self.sigma.tolist()
        information = np.zeros((3, 3))
        information[0, 0] = information[1, 1] = translation**-2
        information[2, 2] = rotation**-2
        return information

    def squared_distance(self, pose: Array) -> float:
        """Return the squared distance of `pose` (3,) from the prediction, in standard deviations."""
        x, y, turn = between(self.pose, pose).tolist()
        linear, angular = self.sigma.tolist()
        return (x * x + y * y) / linear**2 + (turn / angular) ** 2

    def sigma_after(self, information: Array) -> Array:
        """Return (2,) standard deviations [m, rad] of the pose once a scan tells of it with `information` (3, 3).

        That of the translation is along the direction that the scan tells least of.
        """
        linear, angular = np.square(self.sigma).tolist()
        a, b, c = information.item(0, 0), information.item(0, 1), information.item(1, 1)
        least = 0.5 * (a + c) - math.hypot(0.5 * (a - c), b)
        return np.array([(least + 1.0 / linear) ** -0.5, (information.item(2, 2) + 1.0 / angular) ** -0.5])

    def then(self, other: "Prediction") -> "Prediction":
        """Return this motion and the `other` after it as one; their errors are independent."""
        return Prediction(compose(self.pose, other.pose), np.hypot(self.sigma, other.sigma))


class OdometryExtrapolator:
    """Carries the last matched pose on by the motion of the odometry: neither position nor heading lags.

    Args:
        config: Error model.
        odometry: (3,) T_odom_robot at the start; the local frame is the odometry frame there.
    """

    def __init__(self, config: ExtrapolatorConfig, odometry: Array) -> None:
        self._config = config
        self._odometry = odometry
        self._pose = odometry

    def predict(self, odometry: Array) -> Prediction:
        """Return the pose at the odometry pose T_odom_robot (3,)."""
        motion = between(self._odometry, odometry)
        return Prediction(compose(self._pose, motion), self._config.sigma(motion))

    def correct(self, odometry: Array, pose: Array) -> None:
        """Take `pose` (3,) T_local_robot as what belongs to the odometry pose from now on."""
        self._odometry, self._pose = odometry, pose
