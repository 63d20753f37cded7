"""What the kernels of `perception.rgbd.cloud` compute, in plain numpy."""

import numpy as np
from tagalong.perception.rgbd.cloud import _FEWEST, _RADIUS, _STEEPEST, _STEP, Array


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
