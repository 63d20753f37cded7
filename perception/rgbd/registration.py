"""The colour of each pixel of depth, where two cameras beside each other took them."""

import numpy as np
from numpy.typing import NDArray

from .frame import Pinhole, distorted, grey

Array = NDArray[np.float64]

_FROM_OPTICAL = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
"""An optical frame has x to the right, y down and z ahead (REP 103); ours has x ahead, y to the left, z up."""


def turned_optical(T_parent_optical: Array) -> Array:
    """Return T_parent_camera (4, 4) of the frame x ahead, y left, z up of a camera whose optical frame is told."""
    turn = np.eye(4)
    turn[:3, :3] = _FROM_OPTICAL.T
    return np.asarray(T_parent_optical @ turn, dtype=np.float64)


def registered_colour(
    depth: NDArray[np.float32],
    camera: Pinhole,
    colour: NDArray[np.uint8],
    colour_camera: Pinhole,
    T_colour_depth: Array,
) -> NDArray[np.uint8]:
    """Return (h, w, 3) the colour of what each pixel of depth met; grey where it is not known.

    What the colour's camera sees hidden by something nearer gets that one's colour: cameras are some centimetres apart.

    Args:
        depth: (h, w) [m], NaN where nothing was measured.
        camera: That measured it.
        colour: (H, W, 3).
        colour_camera: That took it.
        T_colour_depth: (4, 4) pose of the depth's camera in the colour's, both x ahead, y left, z up.
    """
    result = grey(camera)
    rows, cols = np.nonzero(np.isfinite(depth))
    points = camera.rays[rows, cols] * depth[rows, cols, None].astype(np.float64)
    points = points @ T_colour_depth[:3, :3].T + T_colour_depth[:3, 3]
    ahead = points[:, 0] > 0.01
    rows, cols, points = rows[ahead], cols[ahead], points[ahead]
    right, below = -points[:, 1] / points[:, 0], -points[:, 2] / points[:, 0]
    if any(colour_camera.distortion):
        right, below = distorted(right, below, colour_camera.distortion)
    (across, down), (column, row) = colour_camera.focal, colour_camera.axis
    at = np.floor(np.stack((row + down * below, column + across * right), axis=-1))
    inside = ((at >= 0.0) & (at < colour.shape[:2])).all(axis=-1)
    i, j = at[inside].astype(np.int64).T
    result[rows[inside], cols[inside]] = colour[i, j]
    return result
