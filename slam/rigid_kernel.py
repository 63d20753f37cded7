"""Numba kernel of `geometry.transform_points` for one pose.

It is called some fifteen times a scan on a few points each, where the calls of numpy cost more than the sums.
"""

import numpy as np
from numpy.typing import NDArray

from .view_kernel import kernel


@kernel
def move_points(
    tx: float, ty: float, cos: float, sin: float, points: NDArray[np.float64], moved: NDArray[np.float64]
) -> None:
    """Write `points` (n, 2), turned by an angle of `cos` and `sin` and moved by (`tx`, `ty`), into `moved` (n, 2)."""
    for i in range(len(points)):
        x, y = points[i, 0], points[i, 1]
        moved[i, 0] = tx + cos * x - sin * y
        moved[i, 1] = ty + sin * x + cos * y


@kernel
def moved_points(pose: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return `points` (n, 2), given in the frame at `pose` (3,), in the frame of that pose."""
    moved = np.empty(points.shape)
    move_points(pose[0], pose[1], np.cos(pose[2]), np.sin(pose[2]), points, moved)
    return moved
