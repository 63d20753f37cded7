"""Localization on a known map of objects, on filterpy's extended Kalman filter (Urvina et al. 2023, eq. 14-26)."""

from dataclasses import dataclass

import numpy as np
from filterpy.kalman import ExtendedKalmanFilter
from numpy.typing import ArrayLike, NDArray

from ..bounds import check_numbers, check_points, checked_pose
from ..errors import InputError
from ..geometry import wrap_angle
from .models import measure, measure_jacobian, unicycle, unicycle_jacobian

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class LocalizationConfig:
    """Settings of `ObjectLocalizer`, as in the paper: Q small for true odometry, else larger; P0 high, diagonal.

    Attributes:
        sigma_start: Standard deviation of the first x, y [m] and theta [rad].
        sigma_way: Standard deviation of the way after one second [m].
        sigma_turn: Standard deviation of the turn after one second [rad].
        gate: Largest squared Mahalanobis distance of a sighting to its object.
    """

    sigma_start: float = 1.0
    sigma_way: float = 0.05
    sigma_turn: float = 0.03
    gate: float = 9.21

    def __post_init__(self) -> None:
        check_numbers(self)
        for name, value in vars(self).items():
            if not value > 0.0:
                raise InputError(f"`{name}` must be positive, got {value}")


class ObjectLocalizer:
    """Follows the robot's pose on a map of objects.

    Args:
        objects: (k, 2) the map [m].
        pose: (3,) the first pose.
        config: Settings.

    Attributes:
        filter: filterpy's filter; its `x` is the pose (3,), its `P` the covariance (3, 3).
    """

    def __init__(self, objects: ArrayLike, pose: ArrayLike, config: LocalizationConfig | None = None) -> None:
        self.config = config or LocalizationConfig()
        self.objects = np.asarray(objects, dtype=np.float64).reshape(-1, 2)
        check_points(self.objects, "objects")
        self.filter = ExtendedKalmanFilter(dim_x=3, dim_z=2)
        self.filter.x = checked_pose(pose, "pose")
        self.filter.P = self.config.sigma_start**2 * np.eye(3)

    def predict(self, v: float, omega: float, dt: float) -> None:
        """Move by the unicycle: `v` [m/s], `omega` [rad/s], `dt` [s] (eq. 23-26)."""
        F = unicycle_jacobian(self.filter.x, v, dt)
        self.filter.x = unicycle(self.filter.x, v, omega, dt)
        Q = dt * np.diag([self.config.sigma_way**2, self.config.sigma_way**2, self.config.sigma_turn**2])
        self.filter.P = F @ self.filter.P @ F.T + Q

    def update(self, z: Array, R: Array) -> int:
        """Take sightings `z` (m, 2) of covariance `R` (m, 2, 2); return how many were of known objects (eq. 18-22)."""
        used = 0
        for seen, noise in zip(z, R, strict=True):
            nearest = self._nearest(seen, noise)
            if nearest is None:
                continue
            place = self.objects[nearest][None]
            self.filter.update(
                seen,
                HJacobian=lambda x, place=place: measure_jacobian(x, place)[0],
                Hx=lambda x, place=place: measure(x, place)[0],
                R=noise,
                residual=_innovation,
            )
            self.filter.x[2] = float(wrap_angle(self.filter.x[2]))
            self.filter.P = 0.5 * (self.filter.P + self.filter.P.T)
            used += 1
        return used

    def _nearest(self, seen: Array, noise: Array) -> int | None:
        """Return the object that fits best within the gate, or None."""
        if not len(self.objects):
            return None
        H = measure_jacobian(self.filter.x, self.objects)
        S = H @ self.filter.P @ H.transpose(0, 2, 1) + noise
        y = _innovation(seen, measure(self.filter.x, self.objects))
        distance = np.einsum("ki,ki->k", y, np.linalg.solve(S, y[:, :, None])[:, :, 0])
        best = int(np.argmin(distance))
        return best if distance[best] <= self.config.gate else None


def _innovation(seen: Array, expected: Array) -> Array:
    apart = seen - expected
    apart[..., 1] = wrap_angle(apart[..., 1])
    return apart
