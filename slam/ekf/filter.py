"""The EKF over pose, calibration of the wheels and landmarks, kept symmetric and positive definite.

Legend: x (6 + 2k,) = (pose, calibration, landmarks), P its covariance; only the columns of P that a measurement
touches enter, so that a step grows with the square of the landmarks, not with the cube.
"""

import numpy as np
from filterpy.kalman import ExtendedKalmanFilter
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve

from ..geometry import wrap_angle
from .calibrated_motion import OdometryNoise, advance, advance_jacobian, process_noise
from .models import locate, locate_jacobians, measure, measure_jacobian

Array = NDArray[np.float64]

FIXED = 6
"""States before the landmarks."""
_START_VARIANCE = 1e-8  # of the first pose, which defines the map frame [m^2, rad^2]


class LandmarkFilter(ExtendedKalmanFilter):
    """filterpy's extended Kalman filter with a state that grows and shrinks by landmarks.

    Args:
        pose: (3,) the first pose; it defines the map.
        noise: What is known of the wheels.
    """

    x: Array
    P: Array

    def __init__(self, pose: Array, noise: OdometryNoise) -> None:
        super().__init__(dim_x=FIXED, dim_z=2)
        self.noise = noise
        self.x = np.concatenate((pose, np.zeros(3)))
        calibration = np.array([noise.sigma_scale, noise.sigma_turn, noise.sigma_drift]) ** 2
        self.P = np.diag(np.concatenate((np.full(3, _START_VARIANCE), calibration + 1e-12)))

    @property
    def landmarks(self) -> Array:
        """(k, 2) a copy of the places of the landmarks [m]."""
        return self.x[FIXED:].reshape(-1, 2).copy()

    def move(self, reported: Array) -> None:
        """Predict by the motion (3,) that the wheels report, in the robot's own frame."""
        F = advance_jacobian(self.x[:FIXED], reported)
        Q = process_noise(self.x[:FIXED], reported, self.noise)
        self.x[:FIXED] = advance(self.x[:FIXED], reported)
        self.x[2] = float(wrap_angle(self.x[2]))
        across = F @ self.P[:FIXED, :]
        self.P[:3, 3:], self.P[3:, :3] = across[:, 3:], across[:, 3:].T
        own = across[:, :FIXED] @ F.T + Q
        self.P[:3, :3] = 0.5 * (own + own.T)

    def expect(self, chosen: NDArray[np.int64]) -> tuple[Array, Array, NDArray[np.int64]]:
        """Return what `chosen` landmarks (k,) would measure (k, 2), H (2k, 3 + 2k) and its states (3 + 2k,)."""
        places = self.landmarks[chosen]
        by_pose = measure_jacobian(self.x[:3], places)
        k = len(chosen)
        H = np.zeros((2 * k, 3 + 2 * k))
        H[:, :3] = by_pose.reshape(-1, 3)
        for i in range(k):
            H[2 * i : 2 * i + 2, 3 + 2 * i : 5 + 2 * i] = -by_pose[i, :, :2]
        states = np.concatenate((np.arange(3), (FIXED + 2 * chosen[:, None] + np.arange(2)).ravel()))
        return measure(self.x[:3], places), H, states

    def correct(self, y: Array, R: Array, H: Array, states: NDArray[np.int64]) -> None:
        """Update by innovations `y` (d,) of noise `R` (d, d); `H` (d, s) is the derivative by the `states` (s,).

        Joseph's form, written out: P - K A^T - A K^T + K S K^T with A = P H^T.
        """
        A = self.P[:, states] @ H.T
        S = H @ A[states] + R
        K = cho_solve(cho_factor(0.5 * (S + S.T), check_finite=False), A.T, check_finite=False).T
        self.x = self.x + K @ y
        self.x[2] = float(wrap_angle(self.x[2]))
        half = K @ (0.5 * S @ K.T - A.T)
        self.P += half + half.T

    def add(self, z: Array, R: Array) -> None:
        """Add the landmark seen at `z` (2,) with noise `R` (2, 2)."""
        by_pose, by_z = locate_jacobians(self.x[:3], z)
        n = len(self.x)
        P = np.empty((n + 2, n + 2))
        P[:n, :n] = self.P
        P[n:, :n] = by_pose @ self.P[:3, :]
        P[:n, n:] = P[n:, :n].T
        own = P[n:, :3] @ by_pose.T + by_z @ R @ by_z.T
        P[n:, n:] = 0.5 * (own + own.T)
        self.x, self.P = np.concatenate((self.x, locate(self.x[:3], z))), P

    def overlaps(self, z: Array, radius: float) -> bool:
        """Tell whether a landmark stands where `z` (2,) was seen: two round objects of `radius` [m] cannot overlap.

        Laps would else learn each object many times, by the one sighting in thousands that fails the gates.
        """
        apart = self.landmarks - locate(self.x[:3], z)
        return bool((np.hypot(apart[:, 0], apart[:, 1]) < 2.0 * radius).any())

    def displace(self, pose: Array, variances: Array) -> None:
        """Put the robot at `pose` (3,), which is known to no more than `variances` (3,) beyond what it was."""
        self.x[:3] = pose
        self.P[np.arange(3), np.arange(3)] += variances

    def keep(self, kept: NDArray[np.bool_]) -> None:
        """Forget the landmarks where `kept` (k,) is false."""
        states = np.concatenate((np.ones(FIXED, dtype=bool), np.repeat(kept, 2)))
        self.x, self.P = self.x[states], np.ascontiguousarray(self.P[np.ix_(states, states)])
