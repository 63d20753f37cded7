"""Numba kernels of a scan's cost on the smooth interpolation of a submap, and of its derivatives."""

import numpy as np
from numpy.typing import NDArray

from ..view_kernel import kernel, spliced_kernel

Grid = NDArray[np.float32]
Array = NDArray[np.float64]

_SATURATION = 3.0
_1, _2, _3 = np.uintp(1), np.uintp(2), np.uintp(3)  # with unsigned indices numba need not look for those from the end


@spliced_kernel
def _spline(t: float) -> tuple[float, float, float, float]:
    """Return the four weights of the uniform cubic B-spline at `t` in [0, 1)."""
    s = 1.0 - t
    return (
        s * s * s / 6.0,
        (4.0 + t * t * (3.0 * t - 6.0)) / 6.0,
        (4.0 + s * s * (3.0 * s - 6.0)) / 6.0,
        t * t * t / 6.0,
    )


@spliced_kernel
def _slope(t: float) -> tuple[float, float, float, float]:
    """Return the derivatives of the weights of `_spline`."""
    s = 1.0 - t
    return -0.5 * s * s, t * (1.5 * t - 2.0), -s * (1.5 * s - 2.0), 0.5 * t * t


@spliced_kernel
def _bend(t: float) -> tuple[float, float, float, float]:
    """Return the second derivatives of the weights of `_spline`."""
    return 1.0 - t, 3.0 * t - 2.0, 1.0 - 3.0 * t, t


@spliced_kernel
def _dot(weights, values):  # type: ignore[no-untyped-def]
    """Return the sum of four products; a loop over a tuple would go through memory and take half as long again."""
    return weights[0] * values[0] + weights[1] * values[1] + weights[2] * values[2] + weights[3] * values[3]


@spliced_kernel
def _taps(field, row, col):  # type: ignore[no-untyped-def]
    """Return the four cells of `field` from (row, col) on, along the row."""
    return field[row, col], field[row, col + _1], field[row, col + _2], field[row, col + _3]


@spliced_kernel
def interpolate(field: Grid, u: float, v: float) -> tuple[float, float, float]:
    """Return the bicubic B-spline over `field` (rows, cols) at column `u`, row `v`, and its slopes along u and v.

    Cell centres have whole coordinates. Outside of the grid the field is 0.
    """
    i, j = int(np.floor(u)), int(np.floor(v))
    if i < 1 or j < 1 or i + 2 >= field.shape[1] or j + 2 >= field.shape[0]:
        return 0.0, 0.0, 0.0
    col, row = np.uintp(i - 1), np.uintp(j - 1)
    f0, f1 = _taps(field, row, col), _taps(field, row + _1, col)
    f2, f3 = _taps(field, row + _2, col), _taps(field, row + _3, col)
    wx, wy = _spline(u - i), _spline(v - j)
    slope = _slope(u - i)
    along = _dot(wx, f0), _dot(wx, f1), _dot(wx, f2), _dot(wx, f3)
    du = _dot(wy, (_dot(slope, f0), _dot(slope, f1), _dot(slope, f2), _dot(slope, f3)))
    return _dot(wy, along), du, _dot(_slope(v - j), along)


@spliced_kernel
def interpolate_twice(field: Grid, u: float, v: float) -> tuple[float, float, float, float, float, float]:
    """Return what `interpolate` returns, then the second derivatives along uu, uv and vv."""
    i, j = int(np.floor(u)), int(np.floor(v))
    if i < 1 or j < 1 or i + 2 >= field.shape[1] or j + 2 >= field.shape[0]:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    col, row = np.uintp(i - 1), np.uintp(j - 1)
    f0, f1 = _taps(field, row, col), _taps(field, row + _1, col)
    f2, f3 = _taps(field, row + _2, col), _taps(field, row + _3, col)
    wx, wy = _spline(u - i), _spline(v - j)
    slope_x, slope_y = _slope(u - i), _slope(v - j)
    bend_x = _bend(u - i)
    along = _dot(wx, f0), _dot(wx, f1), _dot(wx, f2), _dot(wx, f3)
    rise = _dot(slope_x, f0), _dot(slope_x, f1), _dot(slope_x, f2), _dot(slope_x, f3)
    duu = _dot(wy, (_dot(bend_x, f0), _dot(bend_x, f1), _dot(bend_x, f2), _dot(bend_x, f3)))
    dvv = _dot(_bend(v - j), along)
    return _dot(wy, along), _dot(wy, rise), _dot(slope_y, along), duu, _dot(slope_y, rise), dvv


@spliced_kernel
def _nearest_convex(xx: float, xy: float, yy: float) -> tuple[float, float, float]:
    """Return the symmetric 2 x 2 matrix (xx, xy, yy) with its negative eigenvalues set to 0."""
    mean, radius = 0.5 * (xx + yy), np.sqrt(0.25 * (xx - yy) * (xx - yy) + xy * xy)
    if mean - radius >= 0.0:
        return xx, xy, yy
    if mean + radius <= 0.0:
        return 0.0, 0.0, 0.0
    share = (mean + radius) / (2.0 * radius)
    return share * (xx - mean + radius), share * xy, share * (yy - mean + radius)


@kernel
def linearize(field: Grid, corner: Array, resolution: float, points: Array, pose: Array, H: Array, g: Array) -> float:
    """Write into `H` (3, 3) and `g` (3,) the normal equations of sum (1 - M); return that sum.

    The residual of a point is r = sqrt(1 - M) with M the interpolated occupancy where it falls: for a wall of
    Gaussian profile r grows linearly with the distance, so Gauss-Newton sees a point-to-line problem, and it levels
    off for points that fall on nothing.
    """
    c, s = np.cos(pose[2]), np.sin(pose[2])
    scale = 1.0 / resolution
    H[:] = 0.0
    g[:] = 0.0
    cost = 0.0
    for n in range(len(points)):
        px, py = c * points[n, 0] - s * points[n, 1], s * points[n, 0] + c * points[n, 1]
        value, du, dv = interpolate(field, (pose[0] + px - corner[0]) * scale, (pose[1] + py - corner[1]) * scale)
        rest = np.exp(-_SATURATION * value)
        cost += rest
        if du == 0.0 and dv == 0.0:
            continue
        jx, jy = -_SATURATION * rest * scale * du, -_SATURATION * rest * scale * dv
        jt = -py * jx + px * jy
        w = 0.5 / (rest + 0.05)
        g[0] += jx
        g[1] += jy
        g[2] += jt
        H[0, 0] += w * jx * jx
        H[0, 1] += w * jx * jy
        H[0, 2] += w * jx * jt
        H[1, 1] += w * jy * jy
        H[1, 2] += w * jy * jt
        H[2, 2] += w * jt * jt
    H[1, 0], H[2, 0], H[2, 1] = H[0, 1], H[0, 2], H[1, 2]
    return cost


@kernel
def misfit(field: Grid, corner: Array, resolution: float, points: Array, pose: Array) -> float:
    """Return sum (1 - M), as `linearize` and `expand` do, without derivatives."""
    c, s = np.cos(pose[2]), np.sin(pose[2])
    scale = 1.0 / resolution
    cost = 0.0
    for n in range(len(points)):
        px, py = c * points[n, 0] - s * points[n, 1], s * points[n, 0] + c * points[n, 1]
        value = interpolate(field, (pose[0] + px - corner[0]) * scale, (pose[1] + py - corner[1]) * scale)[0]
        cost += np.exp(-_SATURATION * value)
    return cost


@kernel
def expand(field: Grid, corner: Array, resolution: float, points: Array, pose: Array, H: Array, g: Array) -> float:
    """Write into `H` (3, 3) and `g` (3,) the second-order expansion of sum (1 - M) by the pose; return that sum.

    The curvature of a point that is not convex counts as the nearest convex one, so H is never indefinite. In the
    middle of a wall, where the slopes vanish, this sees the curvature that the normal equations of `linearize` miss.
    """
    c, s = np.cos(pose[2]), np.sin(pose[2])
    scale = 1.0 / resolution
    H[:] = 0.0
    g[:] = 0.0
    cost = 0.0
    for n in range(len(points)):
        px, py = c * points[n, 0] - s * points[n, 1], s * points[n, 0] + c * points[n, 1]
        u, v = (pose[0] + px - corner[0]) * scale, (pose[1] + py - corner[1]) * scale
        value, du, dv, duu, duv, dvv = interpolate_twice(field, u, v)
        rest = np.exp(-_SATURATION * value)
        cost += rest
        if value == 0.0:
            continue
        first = -_SATURATION * rest * scale
        second = -scale * first
        jx, jy = first * du, first * dv
        xx, xy = second * (_SATURATION * du * du - duu), second * (_SATURATION * du * dv - duv)
        xx, xy, yy = _nearest_convex(xx, xy, second * (_SATURATION * dv * dv - dvv))
        tx, ty = -py * xx + px * xy, -py * xy + px * yy
        g[0] += jx
        g[1] += jy
        g[2] += -py * jx + px * jy
        H[0, 0] += xx
        H[0, 1] += xy
        H[0, 2] += tx
        H[1, 1] += yy
        H[1, 2] += ty
        H[2, 2] += -py * tx + px * ty
    H[1, 0], H[2, 0], H[2, 1] = H[0, 1], H[0, 2], H[1, 2]
    return cost
