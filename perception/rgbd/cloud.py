"""The organized point cloud of a frame, and the surface normal at each point.

Normals come from a property of the pinhole camera: on a plane, the inverse of depth is a linear function of the pixel,
1 / z = a u + b v + c, with (c', a', b') along the plane's normal once u and v are in units of the rays. So a least
squares fit in a window needs no eigenvectors, and holds at any angle. Which neighbours are on the same surface is
told by the same property: at a grazing angle, as on a desk two metres away, depth runs off by a tenth with each row,
and yet its inverse goes on evenly.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from .frame import RgbdFrame

Array = NDArray[np.float64]

_RADIUS = 3
_FEWEST = 12
_STEP = 0.04
_STEEPEST = 0.25


def cloud(frame: RgbdFrame) -> Array:
    """Return (h, w, 3) points in the camera frame (x forward, y left, z up) [m]; NaN where nothing was measured."""
    return frame.camera.rays * frame.depth[..., None].astype(np.float64)


@njit(cache=True, nogil=True)
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


@njit(cache=True, nogil=True)
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


def surface_normals_reference(points: Array, fovs: Array, normals: Array, flatness: Array) -> None:
    """Do what `surface_normals` does, in numpy, by least squares."""
    normals[:], flatness[:] = np.nan, np.inf
    height, width = points.shape[:2]
    for row, col in np.argwhere(np.isfinite(points[..., 0])):
        rows = slice(max(0, row - _RADIUS), min(height, row + _RADIUS + 1))
        cols = slice(max(0, col - _RADIUS), min(width, col + _RADIUS + 1))
        v, u = np.mgrid[rows, cols] - np.array([row, col])[:, None, None]
        z, depth = points[row, col, 0], points[rows, cols, 0]
        inverse = z / depth - 1.0
        a, b = (_slope_reference(points[..., 0], row, col, step) for step in ((0, 1), (1, 0)))
        with np.errstate(invalid="ignore"):
            near = np.abs(inverse - a * u - b * v) < _STEP * np.maximum(np.abs(u) + np.abs(v), 1)
        if near.sum() < _FEWEST:
            continue
        design = np.stack((u[near], v[near], np.ones(near.sum())), axis=-1)
        if np.linalg.matrix_rank(design) < 3:
            continue
        wanted = inverse[near]
        solution = np.linalg.lstsq(design, wanted, rcond=None)[0]
        y, up = points[row, col, 1:] / z
        a, b = solution[:2] / fovs
        normal = np.array([-(1.0 + solution[2] + a * y + b * up), a, b])
        normals[row, col] = normal / np.linalg.norm(normal)
        flatness[row, col] = np.sqrt(np.mean((wanted - design @ solution) ** 2))


def _slope_reference(depth: Array, row: int, col: int, step: tuple[int, int]) -> float:
    padded = np.pad(depth, 1, constant_values=np.nan)[row + 1, col + 1] / np.pad(depth, 1, constant_values=np.nan)
    down, right = step
    changes = [side * (padded[row + 1 + side * down, col + 1 + side * right] - 1.0) for side in (-1, 1)]
    gentle = [change for change in changes if abs(change) < _STEEPEST]
    return min(gentle, key=abs) if gentle else 0.0
