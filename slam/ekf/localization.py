"""Localization on a known map of objects, on filterpy's extended Kalman filter (Urvina et al. 2023, eq. 14-26)."""

import math
from dataclasses import dataclass

import numpy as np
from filterpy.kalman import ExtendedKalmanFilter
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import block_diag

from ..bounds import check_numbers, check_points, check_positive, checked_pose
from ..errors import unknown_name
from ..geometry import compose, wrap_angle
from .association import Pairs, compare, joint_compatibility
from .config import ASSOCIATIONS
from .models import measure, measure_jacobian, unicycle, unicycle_jacobian

Array = NDArray[np.float64]

_REACH = 1.5  # objects so much beyond the farthest sighting are compared, too, besides three sigmas [m]
_MOST_NEAR = 200  # the nearest objects are compared: time and memory grow with their square


@dataclass(frozen=True, kw_only=True)
class LocalizationConfig:
    """Settings of `ObjectLocalizer`, as in the paper: Q small for true odometry, else larger; P0 high, diagonal.

    Attributes:
        sigma_start: Standard deviation of the first x, y [m] and theta [rad].
        sigma_way: Standard deviation of the way after one second [m].
        sigma_turn: Standard deviation of the turn after one second [rad].
        gate: Largest squared Mahalanobis distance of a sighting to its object.
        association: "nearest": each sighting goes to its nearest object, one after the other, as in the paper; "joint":
            joint compatibility, which a start that is not known well, or objects that the map lacks, do not mislead.
    """

    sigma_start: float = 1.0
    sigma_way: float = 0.05
    sigma_turn: float = 0.03
    gate: float = 9.21
    association: str = "nearest"

    def __post_init__(self) -> None:
        check_numbers(self)
        if self.association not in ASSOCIATIONS:
            raise unknown_name("association", self.association, ASSOCIATIONS)
        check_positive(self, "sigma_start", "sigma_way", "sigma_turn", "gate")


class ObjectLocalizer:
    """Follows the robot's pose on a map of objects.

    Args:
        objects: (k, 2) the map [m].
        pose: (3,) the first pose.
        config: Settings.
        covariances: (k, 2, 2) how well the objects' places are known [m^2]; None: exactly.

    Attributes:
        filter: filterpy's filter; its `x` is the pose (3,), its `P` the covariance (3, 3).
    """

    def __init__(
        self,
        objects: ArrayLike,
        pose: ArrayLike,
        config: LocalizationConfig | None = None,
        covariances: ArrayLike | None = None,
    ) -> None:
        self.config = config or LocalizationConfig()
        self.objects = np.asarray(objects, dtype=np.float64).reshape(-1, 2)
        check_points(self.objects, "objects")
        given = np.zeros((len(self.objects), 2, 2)) if covariances is None else covariances
        self.covariances = np.asarray(given, dtype=np.float64)
        self.filter = ExtendedKalmanFilter(dim_x=3, dim_z=2)
        self.filter.x = checked_pose(pose, "pose")
        self.filter.P = self.config.sigma_start**2 * np.eye(3)

    @property
    def pose(self) -> Array:
        """(3,) T_map_robot, the best estimate now."""
        return self.filter.x.copy()

    def move(self, motion: Array, dt: float) -> None:
        """Move by what odometry says of the last `dt` [s]: `motion` (3,), in the robot's own frame [m, m, rad].

        The paper's unicycle knows only wheel speeds; odometry says the whole motion, of robots that go sideways, too.
        """
        before = self.filter.x
        self.filter.x = compose(before, motion)
        dx, dy = self.filter.x[:2] - before[:2]
        self._spread(np.array([[1.0, 0.0, -dy], [0.0, 1.0, dx], [0.0, 0.0, 1.0]]), dt)

    def predict(self, v: float, omega: float, dt: float) -> None:
        """Move by the unicycle: `v` [m/s], `omega` [rad/s], `dt` [s] (eq. 23-26)."""
        F = unicycle_jacobian(self.filter.x, v, dt)
        self.filter.x = unicycle(self.filter.x, v, omega, dt)
        self._spread(F, dt)

    def _spread(self, F: Array, dt: float) -> None:
        """Carry the covariance on by the derivative `F` (3, 3) of the motion of `dt` [s]."""
        Q = dt * np.diag([self.config.sigma_way**2, self.config.sigma_way**2, self.config.sigma_turn**2])
        self.filter.P = F @ self.filter.P @ F.T + Q

    def restart(self) -> None:
        """Know the pose as badly as at the start again."""
        self.filter.P = self.config.sigma_start**2 * np.eye(3)

    def update(self, z: Array, R: Array) -> int:
        """Take sightings `z` (m, 2) of covariance `R` (m, 2, 2); return how many were of known objects (eq. 18-22)."""
        if self.config.association == "joint":
            pairs = self._jointly(z, R)
            for i, j in pairs:
                self._correct(z[i], R[i], j)
            return len(pairs)
        used = 0
        for seen, noise in zip(z, R, strict=True):
            nearest = self._nearest(seen, noise)
            if nearest is not None:
                self._correct(seen, noise, nearest)
                used += 1
        return used

    def _correct(self, seen: Array, noise: Array, number: int) -> None:
        """Correct the pose by the sighting `seen` (2,) of the object with this number."""
        place = self.objects[number][None]
        self.filter.update(
            seen,
            HJacobian=lambda x: measure_jacobian(x, place)[0],
            Hx=lambda x: measure(x, place)[0],
            R=noise + self._of_places(measure_jacobian(self.filter.x, place), self.covariances[[number]])[0],
            residual=_innovation,
        )
        self.filter.x[2] = float(wrap_angle(self.filter.x[2]))
        self.filter.P = 0.5 * (self.filter.P + self.filter.P.T)

    def _of_places(self, H: Array, covariances: Array) -> Array:
        """Return what the `covariances` (k, 2, 2) of places add to measurements, by the derivatives `H` (k, 2, 3)."""
        return H[:, :, :2] @ covariances @ H[:, :, :2].transpose(0, 2, 1)

    def _nearest(self, seen: Array, noise: Array) -> int | None:
        """Return the object that fits best within the gate, or None."""
        if not len(self.objects):
            return None
        H = measure_jacobian(self.filter.x, self.objects)
        S = H @ self.filter.P @ H.transpose(0, 2, 1) + (noise + self._of_places(H, self.covariances))
        y = _innovation(seen, measure(self.filter.x, self.objects))
        distance = np.einsum("ki,ki->k", y, np.linalg.solve(S, y[:, :, None])[:, :, 0])
        best = int(np.argmin(distance))
        return best if distance[best] <= self.config.gate else None

    def _jointly(self, z: Array, R: Array) -> Pairs:
        """Return which sighting is of which object: as many pairs as one pose explains together."""
        away = np.hypot(*(self.objects - self.filter.x[:2]).T)
        farthest = z[:, 0].max(initial=0.0) + _REACH + 3.0 * math.sqrt(float(np.trace(self.filter.P[:2, :2])))
        near = np.argsort(away, kind="stable")[:_MOST_NEAR]
        near = near[away[near] <= farthest]
        H = measure_jacobian(self.filter.x, self.objects[near])
        flat = H.reshape(-1, 3)
        places = block_diag(*self._of_places(H, self.covariances[near]), np.empty((0, 0)))
        HPH = flat @ self.filter.P @ flat.T + np.asarray(places, dtype=np.float64)
        pairs = compare(z, R, measure(self.filter.x, self.objects[near]), HPH)
        return [(i, int(near[j])) for i, j in joint_compatibility(pairs, self.config.gate)]


def _innovation(seen: Array, expected: Array) -> Array:
    apart = seen - expected
    apart[..., 1] = wrap_angle(apart[..., 1])
    return apart
