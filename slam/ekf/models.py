"""The unicycle and the range-bearing measurement, with Jacobians.

Legend: x = (x, y, theta) T_map_robot; z = (r, b) range and bearing of an object from the robot; (u, v, w) the motion in
the robot's own frame [m, m, rad].

Printed wrongly in Urvina et al. 2023, and what is right:
- eq. 16 and 19: arctan(dy / dx) loses the quadrant; atan2 is needed, and the innovation's angle must be wrapped.
- eq. 18, 21, 22, 25, 26: the predicted state and covariance have the index t|t-1, K_t = S H^T (R + H S H^T)^-1, and the
  posterior of eq. 22 is that of t|t.
- eq. 20: with dx = x_i - x_v and dy = y_i - y_v, H = [[-dx/r, -dy/r, 0], [dy/r^2, -dx/r^2, -1]]: the signs of the whole
  first row and of the second entry of the second row are wrong in print.
- eq. 23: the right-hand side is the state at k, not k + 1.
- eq. 24: F lacks v, and has sin for cos in its second row: [[1, 0, -dt v sin], [0, 1, dt v cos], [0, 0, 1]].
"""

import numpy as np
from numpy.typing import NDArray

from ..geometry import wrap_angle

Array = NDArray[np.float64]


def unicycle(pose: Array, v: float, omega: float, dt: float) -> Array:
    """Return the pose (3,) after `dt` [s] at `v` [m/s] and `omega` [rad/s], by Euler's rule as in eq. 23."""
    x, y, theta = pose.tolist()
    return np.array([x + dt * v * np.cos(theta), y + dt * v * np.sin(theta), float(wrap_angle(theta + dt * omega))])


def unicycle_jacobian(pose: Array, v: float, dt: float) -> Array:
    """Return F (3, 3), the derivative of `unicycle` by the pose (eq. 24, put right)."""
    sin, cos = np.sin(pose[2]), np.cos(pose[2])
    return np.array([[1.0, 0.0, -dt * v * sin], [0.0, 1.0, dt * v * cos], [0.0, 0.0, 1.0]])


def measure(pose: Array, objects: Array) -> Array:
    """Return h (m, 2): range and bearing of `objects` (m, 2) from `pose` (3,) (eq. 19, with atan2)."""
    dx, dy = objects[:, 0] - pose[0], objects[:, 1] - pose[1]
    return np.stack((np.hypot(dx, dy), wrap_angle(np.arctan2(dy, dx) - pose[2])), axis=-1)


def measure_jacobian(pose: Array, objects: Array) -> Array:
    """Return H (m, 2, 3), the derivative of `measure` by the pose (eq. 20, put right).

    The derivative by the object itself is `-H[:, :, :2]`. An object at the robot's place counts as 1 mm away.
    """
    dx, dy = objects[:, 0] - pose[0], objects[:, 1] - pose[1]
    r = np.maximum(np.hypot(dx, dy), 1e-3)
    H = np.zeros((len(objects), 2, 3))
    H[:, 0, 0], H[:, 0, 1] = -dx / r, -dy / r
    H[:, 1, 0], H[:, 1, 1], H[:, 1, 2] = dy / r**2, -dx / r**2, -1.0
    return H


def locate(pose: Array, z: Array) -> Array:
    """Return (2,) the place of the object that is seen at `z` (2,) from `pose` (3,): the inverse of `measure`."""
    angle = pose[2] + z[1]
    return pose[:2] + z[0] * np.array([np.cos(angle), np.sin(angle)])


def locate_jacobians(pose: Array, z: Array) -> tuple[Array, Array]:
    """Return the derivatives of `locate` by the pose (2, 3) and by z (2, 2)."""
    angle = pose[2] + z[1]
    cos, sin = float(np.cos(angle)), float(np.sin(angle))
    by_pose = np.array([[1.0, 0.0, -z[0] * sin], [0.0, 1.0, z[0] * cos]])
    return by_pose, np.array([[cos, -z[0] * sin], [sin, z[0] * cos]])
