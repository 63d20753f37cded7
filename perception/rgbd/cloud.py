"""The organized point cloud of a frame, and the surface normal at each point.

Normals come from a property of the pinhole camera: on a plane, the inverse of depth is a linear function of the pixel,
1 / z = a u + b v + c, with (c', a', b') along the plane's normal once u and v are in units of the rays. So a least
squares fit in a window needs no eigenvectors, and holds at any angle. Which neighbours are on the same surface is
told by the same property: at a grazing angle, as on a desk two metres away, depth runs off by a tenth with each row,
and yet its inverse goes on evenly.
"""

import numpy as np
from numpy.typing import NDArray

from ...slam.view_kernel import kernel
from .frame import RgbdFrame

Array = NDArray[np.float64]

_RADIUS = 3
_FEWEST = 12
_STEP = 0.04
_STEEPEST = 0.25


def cloud(frame: RgbdFrame) -> Array:
    """Return (h, w, 3) points in the camera frame (x forward, y left, z up) [m]; NaN where nothing was measured."""
    return frame.camera.rays * frame.depth[..., None].astype(np.float64)


@kernel
def _slope(points, row, col, down, right):
    """Return by how much z / depth changes from one pixel to the next: the gentler of both sides, 0 if neither is."""
    z, slope = points[row, col, 0], np.inf
    for side in (-1, 1):
        i, j = row + side * down, col + side * right
        if 0 <= i < points.shape[0] and 0 <= j < points.shape[1]:
            change = side * (z / points[i, j, 0] - 1.0)
            if abs(change) < abs(slope):
                slope = change
    return slope if abs(slope) < _STEEPEST else 0.0


@kernel
def surface_normals(points, fovs, normals, flatness):
    """Write the normal at each point, towards the camera, and how flat its neighbourhood is.

    Args:
        points: (h, w, 3) in the camera frame [m], NaN where nothing was measured.
        fovs: (2,) width of a pixel and its height, in units of the rays [1].
        normals: (h, w, 3) written; NaN where there are fewer than 12 neighbours on the same surface.
        flatness: (h, w) written; root mean square of the relative error of depth, `inf` where there is no normal.
    """
    height, width = points.shape[:2]
    for row in range(height):
        for col in range(width):
            normals[row, col] = np.nan
            flatness[row, col] = np.inf
            z = points[row, col, 0]
            if not np.isfinite(z):
                continue
            across, down = _slope(points, row, col, 0, 1), _slope(points, row, col, 1, 0)
            n, su, sv, suu, suv, svv, sq, suq, svq, sqq = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
            for i in range(max(0, row - _RADIUS), min(height, row + _RADIUS + 1)):
                for j in range(max(0, col - _RADIUS), min(width, col + _RADIUS + 1)):
                    u, v, q = float(j - col), float(i - row), z / points[i, j, 0] - 1.0
                    if not abs(q - across * u - down * v) < _STEP * max(abs(u) + abs(v), 1.0):
                        continue
                    n, su, sv, sq = n + 1.0, su + u, sv + v, sq + q
                    suu, suv, svv = suu + u * u, suv + u * v, svv + v * v
                    suq, svq, sqq = suq + u * q, svq + v * q, sqq + q * q
            if n < _FEWEST:
                continue
            a11, a12, a22 = suu - su * su / n, suv - su * sv / n, svv - sv * sv / n
            b1, b2 = suq - su * sq / n, svq - sv * sq / n
            det = a11 * a22 - a12 * a12
            if det < 1e-6 * a11 * a22 or det <= 0.0:
                continue
            a, b = (b1 * a22 - b2 * a12) / det, (b2 * a11 - b1 * a12) / det
            middle = sq / n - a * su / n - b * sv / n
            y, up = points[row, col, 1] / z, points[row, col, 2] / z
            nx = -(1.0 + middle + a * y / fovs[0] + b * up / fovs[1])
            ny, nz = a / fovs[0], b / fovs[1]
            size = np.sqrt(nx * nx + ny * ny + nz * nz)
            normals[row, col, 0], normals[row, col, 1], normals[row, col, 2] = nx / size, ny / size, nz / size
            error = sqq - sq * sq / n - a * b1 - b * b2
            flatness[row, col] = np.sqrt(max(error, 0.0) / n)
