"""Constant-velocity Kalman filter for many targets in one update (Ye 2021, eq. 3 to 5).

Letters: x state (x, y, vx, vy); P its covariance; Q = q I process noise; R = r I measurement noise; K gain.

With Q, R and P0 multiples of I, x and y are two equal, independent filters: P = kron([[a, b], [b, c]], I2) for all
time, with a = var(x) = var(y), b = cov(x, vx) = cov(y, vy), c = var(vx) = var(vy). So a target's P is three numbers and
an update of all targets is a few array operations. Equal to filterpy's `KalmanFilter` (tested).
"""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...slam.view_kernel import kernel, view_kernel

if TYPE_CHECKING:
    from filterpy.kalman import KalmanFilter

Array = NDArray[np.float64]


@view_kernel
def predict_state(x, p, dt, q):
    """Move one state `x` (4,) and covariance `p` (3,) `dt` [s] ahead (eq. 4a, 4b) with process noise `q`."""
    x[0] += dt * x[2]
    x[1] += dt * x[3]
    a, b, c = p[0], p[1], p[2]
    p[0], p[1], p[2] = a + 2.0 * dt * b + dt * dt * c + q, b + dt * c, c + q


@kernel
def correct_state(x, p, u, v, r):
    """Correct one state `x` (4,) and covariance `p` (3,) by the measured position (u, v) (eq. 4c to 4e)."""
    k, gain = p[0] / (p[0] + r), p[1] / (p[0] + r)
    dx, dy = u - x[0], v - x[1]
    x[0] += k * dx
    x[1] += k * dy
    x[2] += gain * dx
    x[3] += gain * dy
    p[2] -= gain * p[1]
    p[0], p[1] = (1.0 - k) * p[0], (1.0 - k) * p[1]


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
