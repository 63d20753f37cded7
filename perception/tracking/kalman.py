"""Constant-velocity Kalman filter for many targets in one update (Ye 2021, eq. 3 to 5).

Letters: x state (x, y, vx, vy); P its covariance; Q = q I process noise; R = r I measurement noise; K gain.

With Q, R and P0 multiples of I, x and y are two equal, independent filters: P = kron([[a, b], [b, c]], I2) for all
time, with a = var(x) = var(y), b = cov(x, vx) = cov(y, vy), c = var(vx) = var(vy). So a target's P is three numbers and
an update of all targets is a few array operations. Equal to filterpy's `KalmanFilter` (tested).
"""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from filterpy.kalman import KalmanFilter

Array = NDArray[np.float64]


def predict(x: Array, p: Array, dt: float, q: float) -> tuple[Array, Array]:
    """Return states and covariances `dt` seconds later (eq. 4a, 4b).

    Args:
        x: (n, 4) states.
        p: (n, 3) covariances (a, b, c).
        dt: Time step [s].
        q: Diagonal of Q for this step.
    """
    a, b, c = p[:, 0], p[:, 1], p[:, 2]
    later = x.copy()
    later[:, :2] += dt * x[:, 2:]
    return later, np.stack((a + 2.0 * dt * b + dt * dt * c + q, b + dt * c, c + q), axis=1)


def update(x: Array, p: Array, z: Array, r: float | Array) -> tuple[Array, Array]:
    """Return states and covariances after the measured positions `z` (n, 2) (eq. 4c to 4e); `r` is a number or (n,)."""
    a, b, c = p[:, 0], p[:, 1], p[:, 2]
    k_position, k_velocity = a / (a + r), b / (a + r)
    y = z - x[:, :2]
    after = np.concatenate((x[:, :2] + k_position[:, None] * y, x[:, 2:] + k_velocity[:, None] * y), axis=1)
    return after, np.stack(((1.0 - k_position) * a, (1.0 - k_position) * b, c - k_velocity * b), axis=1)


def full_covariance(p: Array) -> Array:
    """Return (n, 4, 4) covariances in the order (x, y, vx, vy) from the three numbers (n, 3)."""
    return np.asarray(np.kron(np.stack((p[:, :2], p[:, 1:]), axis=1), np.eye(2)), dtype=np.float64)


def single_target(position: ArrayLike, variance: float, r: float) -> "KalmanFilter":
    """Return filterpy's filter of a target at `position` (2,), at rest (eq. 5): P0 = `variance` I, R = r I."""
    from filterpy.kalman import KalmanFilter  # takes most of a second, which the filter of a short log has no use for

    filter_ = KalmanFilter(dim_x=4, dim_z=2)
    filter_.x = np.concatenate((np.asarray(position, dtype=np.float64), np.zeros(2)))
    filter_.P = np.eye(4) * variance
    filter_.H = np.eye(2, 4)
    filter_.R = np.eye(2) * r
    return filter_


def predict_single(filter_: "KalmanFilter", dt: float, q: float) -> None:
    """Move `filter_` `dt` seconds ahead with Q = q I."""
    filter_.F = np.eye(4) + dt * np.eye(4, k=2)
    filter_.Q = np.eye(4) * q
    filter_.predict()
