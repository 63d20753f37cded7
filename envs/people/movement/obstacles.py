"""Walls and furniture as people walk round them: boxes (b, 6) and circles (c, 3).

A box is a row of centre x and y, cos and sin of its yaw, half length, half width; a circle of x, y, radius [m].
"""

import math

import numpy as np
from numpy.typing import NDArray

from ....slam.view_kernel import inner_view_kernel, view_kernel

Array = NDArray[np.float64]


@view_kernel
def nearest_of_box(x: float, y: float, box: Array) -> tuple[float, float, float]:
    """Return the distance from a point to a box (negative inside) and the unit vector away from it.

    Args:
        x: Of the point [m].
        y: Of the point [m].
        box: (6,) centre x and y, cos and sin of its yaw, half length, half width.
    """
    along = box[2] * (x - box[0]) + box[3] * (y - box[1])
    across = box[2] * (y - box[1]) - box[3] * (x - box[0])
    return nearest_of_rectangle(along, across, box[2], box[3], box[4], box[5])


@inner_view_kernel
def nearest_of_rectangle(
    along: float, across: float, cos: float, sin: float, half_length: float, half_width: float
) -> tuple[float, float, float]:
    """Return what `nearest_of_box` does of a point that is given in the box' own frame [m]; cos and sin of its yaw."""
    out_along, out_across = abs(along) - half_length, abs(across) - half_width
    if out_along <= 0.0 and out_across <= 0.0:
        distance = max(out_along, out_across)
        u = (1.0 if along >= 0.0 else -1.0) if out_along > out_across else 0.0
        v = (1.0 if across >= 0.0 else -1.0) if out_along <= out_across else 0.0
    else:
        u, v = max(out_along, 0.0), max(out_across, 0.0)
        distance = math.sqrt(u * u + v * v)
        u, v = math.copysign(u, along) / distance, math.copysign(v, across) / distance
    return distance, cos * u - sin * v, sin * u + cos * v


@view_kernel
def is_clear(x: float, y: float, boxes: Array, circles: Array, clearance: float) -> bool:
    """Return whether nothing is nearer to a point than `clearance` [m]."""
    for k in range(len(boxes)):
        if abs(boxes[k, 0] - x) + abs(boxes[k, 1] - y) < boxes[k, 4] + boxes[k, 5] + 2.0 * clearance:
            distance, _, _ = nearest_of_box(x, y, boxes[k])
            if distance < clearance:
                return False
    clear = True
    for k in range(len(circles)):
        clear = clear and math.hypot(x - circles[k, 0], y - circles[k, 1]) >= circles[k, 2] + clearance
    return clear
