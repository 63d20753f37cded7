"""A laser's beams against what is cut by its plane: rectangles, circles and ellipses, each by the beams it can meet.

A face touches the beams between its two ends only; of a building few faces look at the robot, and along the beams of
one of them a division a beam is all there is to do. The ends are found by a coarse angle and settled by a sign, so
that no beam is lost or won between two faces that share an edge. `sensors.ray_kernel` is the same for MuJoCo's bodies,
to the bit; here a beam costs a tenth, and is equal within rounding.
"""

import math

import numpy as np
from numpy.typing import NDArray

from ...slam.view_kernel import inner_view_kernel

Array = NDArray[np.float64]

_TAU = 2.0 * np.pi
_ROUGH = 5e-4
"""Error of `_rough_angle`, rounded up [rad]."""


@inner_view_kernel
def _rough_angle(x: float, y: float) -> float:
    """Return the direction of (x, y) within 3e-4 rad, in [-pi, pi]."""
    ax, ay = abs(x), abs(y)
    large = max(ax, ay)
    m = min(ax, ay) / large if large > 0.0 else 0.0
    s = m * m
    angle = ((-0.0464964749 * s + 0.15931422) * s - 0.327622764) * s * m + m
    if ay > ax:
        angle = 0.5 * np.pi - angle
    if x < 0.0:
        angle = np.pi - angle
    return -angle if y < 0.0 else angle


@inner_view_kernel
def point_beams(heading: float, cos_bearing: Array, sin_bearing: Array, ux: Array, uy: Array) -> None:
    """Write the unit vectors `ux`, `uy` (n,) of beams with the bearings (n,) for a laser that looks to `heading`."""
    cos, sin = math.cos(heading), math.sin(heading)
    for j in range(len(ux)):
        ux[j] = cos * cos_bearing[j] - sin * sin_bearing[j]
        uy[j] = sin * cos_bearing[j] + cos * sin_bearing[j]


@inner_view_kernel
def cast_faces(ax: float, ay: float, bx: float, by: float, first: float, spacing: float, beams: Array) -> None:
    """Let the beams meet a straight face between two points, seen from the laser; either order.

    Args:
        ax: One end, from the laser, in the world's axes [m].
        ay: The same.
        bx: The other end [m].
        by: The same.
        first: Direction of the first beam in the world [rad].
        spacing: Between two beams [rad].
        beams: (3, n) unit vectors x and y, and the distance so far [m], updated.
    """
    cross = ax * by - ay * bx
    if cross < 0.0:
        ax, ay, bx, by, cross = bx, by, ax, ay, -cross
    if cross < 1e-9:
        return
    ux, uy, exact = beams[0], beams[1], beams[2]
    count = len(exact)
    one = _rough_angle(ax, ay)
    width, start = (_rough_angle(bx, by) - one) % _TAU, (one - first - _ROUGH) % _TAU
    width = (width if width < 1.5 * np.pi else 0.0) + 2.0 * _ROUGH  # a face is never seen under more than pi
    ex, ey = bx - ax, by - ay
    for turn in range(2):
        begin = start - turn * _TAU
        low = max(np.int64(math.ceil(begin / spacing)), 0)  # a GPU's ceil and floor are no whole numbers yet
        high = min(np.int64(math.floor((begin + width) / spacing)), count - 1)
        while low <= high and ax * uy[low] - ay * ux[low] < 0.0:
            low += 1
        while low <= high and ux[high] * by - uy[high] * bx < 0.0:
            high -= 1
        for j in range(low, high + 1):
            at = cross / (ux[j] * ey - uy[j] * ex)
            exact[j] = at if at < exact[j] else exact[j]


@inner_view_kernel
def cast_rectangle(x: float, y: float, row: Array, first: float, spacing: float, beams: Array) -> None:
    """Let the beams of a laser at (x, y) meet a rectangle (centre x and y, cos and sin of its yaw, half sides)."""
    cos, sin, half_x, half_y = row[2], row[3], row[4], row[5]
    dx, dy = row[0] - x, row[1] - y
    px, py = -(cos * dx + sin * dy), -(cos * dy - sin * dx)  # the laser, seen from the rectangle
    ux, uy, vx, vy = cos * half_x, sin * half_x, -sin * half_y, cos * half_y
    if abs(px) > half_x:
        side = 1.0 if px > 0.0 else -1.0
        mx, my = dx + side * ux, dy + side * uy
        cast_faces(mx - vx, my - vy, mx + vx, my + vy, first, spacing, beams)
    if abs(py) > half_y:
        side = 1.0 if py > 0.0 else -1.0
        mx, my = dx + side * vx, dy + side * vy
        cast_faces(mx - ux, my - uy, mx + ux, my + uy, first, spacing, beams)
    elif abs(px) <= half_x:  # in it: all four, from within
        for side in (-1.0, 1.0):
            cast_faces(dx + side * ux - vx, dy + side * uy - vy, dx + side * ux + vx, dy + side * uy + vy,
                       first, spacing, beams)  # fmt: skip
            cast_faces(dx + side * vx - ux, dy + side * vy - uy, dx + side * vx + ux, dy + side * vy + uy,
                       first, spacing, beams)  # fmt: skip


@inner_view_kernel
def cast_ellipse(
    dx: float, dy: float, xx: float, xy: float, yy: float, radius: float, first: float, spacing: float, beams: Array
) -> None:
    """Let the beams meet an ellipse.

    Args:
        dx: Its centre, from the laser [m].
        dy: The same.
        xx: Of the form xx x^2 + 2 xy x y + yy y^2 that is 1 on its rim [1/m^2].
        xy: The same.
        yy: The same.
        radius: Of a circle around it [m].
        first: Direction of the first beam in the world [rad].
        spacing: Between two beams [rad].
        beams: (3, n) as in `cast_faces`.
    """
    ux, uy, exact = beams[0], beams[1], beams[2]
    apart = dx * dx + dy * dy - radius * radius
    half = _rough_angle(math.sqrt(apart), radius) + 2.0 * _ROUGH if apart > 0.0 else np.pi
    start = (_rough_angle(dx, dy) - half - first) % _TAU if apart > 0.0 else 0.0
    gx, gy = xx * dx + xy * dy, xy * dx + yy * dy
    outside = gx * dx + gy * dy - 1.0
    for turn in range(2):
        begin = start - turn * _TAU
        low = max(np.int64(math.ceil(begin / spacing)), 0)
        high = min(np.int64(math.floor((begin + 2.0 * half) / spacing)), len(exact) - 1)
        for j in range(low, high + 1):
            u, v = ux[j], uy[j]
            a, b = xx * u * u + 2.0 * xy * u * v + yy * v * v, gx * u + gy * v
            within = b * b - a * outside
            if within > 0.0:
                root = math.sqrt(within)
                at = (b - root) / a if b >= root else (b + root) / a
                if 0.0 <= at < exact[j]:
                    exact[j] = at
