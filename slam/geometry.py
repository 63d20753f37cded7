"""Rigid motions of the plane.

A pose is `(x, y, theta)` in metres and radians, theta in [-pi, pi). `T_a_b` is the pose of frame b in frame a; it maps
coordinates in b to coordinates in a. All functions broadcast over leading axes and return new float64 arrays.
"""

import math

import numpy as np
from numba.extending import register_jitable
from numpy.typing import ArrayLike, NDArray

from .rigid_kernel import move_points

Array = NDArray[np.float64]

_STRAIGHT = 1e-6  # [rad] a motion that turns less is one


def wrap_angle(angle: ArrayLike) -> Array:
    """Return `angle` [rad] wrapped to [-pi, pi)."""
    wrapped: Array = (np.asarray(angle, dtype=np.float64) + np.pi) % (2.0 * np.pi) - np.pi
    return np.where(wrapped >= np.pi, -np.pi, wrapped).astype(np.float64)


@register_jitable
def wrap_one(angle: float) -> float:
    """Return one `angle` [rad] wrapped to [-pi, pi), at a tenth of the cost of `wrap_angle`."""
    wrapped = (angle + math.pi) % (2.0 * math.pi) - math.pi
    return -math.pi if wrapped >= math.pi else wrapped


def compose(T_a_b: ArrayLike, T_b_c: ArrayLike) -> Array:
    """Return T_a_c, the pose of c in a. Shapes (..., 3) and (..., 3), broadcast."""
    outer, inner = _array(T_a_b), _array(T_b_c)
    if outer.ndim == 1 and inner.ndim == 1:  # one pose, the usual case: ten times faster without broadcasting
        return np.array(composed(*outer.tolist(), *inner.tolist()))
    cos, sin = np.cos(outer[..., 2]), np.sin(outer[..., 2])
    return np.stack(
        np.broadcast_arrays(
            outer[..., 0] + cos * inner[..., 0] - sin * inner[..., 1],
            outer[..., 1] + sin * inner[..., 0] + cos * inner[..., 1],
            wrap_angle(outer[..., 2] + inner[..., 2]),
        ),
        axis=-1,
    )


def inverse(T_a_b: ArrayLike) -> Array:
    """Return T_b_a. Shape (..., 3)."""
    pose = _array(T_a_b)
    if pose.ndim == 1:
        return np.array(inverted(*pose.tolist()))
    cos, sin = np.cos(pose[..., 2]), np.sin(pose[..., 2])
    return np.stack(
        (
            -cos * pose[..., 0] - sin * pose[..., 1],
            sin * pose[..., 0] - cos * pose[..., 1],
            wrap_angle(-pose[..., 2]),
        ),
        axis=-1,
    )


def between(T_w_a: ArrayLike, T_w_b: ArrayLike) -> Array:
    """Return T_a_b, the pose of b seen from a, from both poses in a common frame. Shapes (..., 3), broadcast."""
    first, second = _array(T_w_a), _array(T_w_b)
    if first.ndim == 1 and second.ndim == 1:
        return np.array(composed(*inverted(*first.tolist()), *second.tolist()))
    return compose(inverse(first), second)


def _array(pose: ArrayLike) -> Array:
    """Return `pose` as an array of floats, itself if it is one: a call takes as long as the sums of a pose."""
    return pose if isinstance(pose, np.ndarray) and pose.dtype == np.float64 else np.asarray(pose, dtype=np.float64)


@register_jitable
def composed(x: float, y: float, theta: float, u: float, v: float, phi: float) -> tuple[float, float, float]:
    """Return the pose that `compose` returns for (x, y, theta) and (u, v, phi); kernels may call it."""
    cos, sin = math.cos(theta), math.sin(theta)
    return x + cos * u - sin * v, y + sin * u + cos * v, wrap_one(theta + phi)


def inverted(x: float, y: float, theta: float) -> tuple[float, float, float]:
    """Return the pose that `inverse` returns for (x, y, theta)."""
    cos, sin = math.cos(theta), math.sin(theta)
    return -cos * x - sin * y, sin * x - cos * y, wrap_one(-theta)


def stands(motion: ArrayLike) -> bool:
    """Return whether a motion (3,) that odometry tells is none: to a millimetre and a thousandth of a radian."""
    x, y, turn = np.abs(motion)
    return bool(x < 1e-3 and y < 1e-3 and turn < 1e-3)


def part_of(motion: ArrayLike, share: float) -> Array:
    """Return (3,) the first `share` of a `motion` (3,) at constant velocities, in [0, 1]: along an arc."""
    x, y, turn = _array(motion).tolist()
    return np.array(arc_part(x, y, turn, share))


def arc_part(x: float, y: float, turn: float, share: float) -> tuple[float, float, float]:
    """Return the motion that `part_of` returns for (x, y, turn)."""
    part = share * turn
    if abs(turn) < _STRAIGHT:
        return share * x, share * y, part
    # A turn by t about the centre c leads from 0 to c - R(t) c.
    half = 0.5 / math.tan(0.5 * turn)
    cx, cy = 0.5 * x - half * y, half * x + 0.5 * y
    cos, sin = math.cos(part), math.sin(part)
    return cx - cos * cx + sin * cy, cy - sin * cx - cos * cy, part


def first_of_way(steps: ArrayLike, goal: ArrayLike) -> Array:
    """Return (3,) the first of `steps` (n, 3), one after the other, once all are changed alike to lead to `goal` (3,).

    Steps of zero make a straight line of equal turns of it.
    """
    ways, aim = np.array(steps, dtype=np.float64), _array(goal)
    ways[:, 2] += wrap_one(aim[2] - ways[:, 2].sum()) / len(ways)
    end = np.zeros(3)
    for way in ways:
        end = compose(end, way)
    first = ways[0]
    first[:2] += (aim[:2] - end[:2]) / len(ways)
    return first


def turning(heading: float) -> Array:
    """Return (3, 3) what turns a motion (3,) by `heading` [rad]."""
    cos, sin = math.cos(heading), math.sin(heading)
    return np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])


def transform_points(T_a_b: ArrayLike, points_b: ArrayLike) -> Array:
    """Return `points_b` (..., N, 2) in frame a. `T_a_b` is (3,), or (..., 3) as the points."""
    pose, points = np.asarray(T_a_b, dtype=np.float64), np.asarray(points_b, dtype=np.float64)
    if pose.ndim == 1 and points.ndim == 2:
        tx, ty, theta = pose.tolist()
        moved = np.empty(points.shape)
        move_points(tx, ty, math.cos(theta), math.sin(theta), np.ascontiguousarray(points), moved)
        return moved
    cos, sin = np.cos(pose[..., 2, None]), np.sin(pose[..., 2, None])
    x, y = points[..., 0], points[..., 1]
    return np.stack((pose[..., 0, None] + cos * x - sin * y, pose[..., 1, None] + sin * x + cos * y), axis=-1)
