"""What the kernels of `perception.rgbd.hog` compute, in plain numpy."""

import numpy as np
from numpy.typing import NDArray
from tagalong.perception.rgbd.hog import _CUT, BINS, CELL


def hog_reference(patches: NDArray[np.float32], softness: float, features: NDArray[np.float32]) -> None:
    """Do what `hog` does, in numpy."""
    n, channels, height, width = patches.shape
    rows, cols = height // CELL, width // CELL
    picture = patches.astype(np.float64)
    down, across = np.zeros_like(picture), np.zeros_like(picture)
    down[..., 1:-1, :] = picture[..., 2:, :] - picture[..., :-2, :]
    across[..., 1:-1] = picture[..., 2:] - picture[..., :-2]
    direction = np.minimum((np.degrees(np.arctan2(down, across)) % 180.0 * BINS / 180.0).astype(int), BINS - 1)
    size = np.hypot(down, across)[..., None] * (direction[..., None] == np.arange(BINS))
    cells = size.reshape(n, channels, rows, CELL, cols, CELL, BINS).mean(axis=(3, 5))
    corners = (cells[:, :, :-1, :-1], cells[:, :, :-1, 1:], cells[:, :, 1:, :-1], cells[:, :, 1:, 1:])
    blocks = np.concatenate(corners, axis=-1)
    blocks = np.minimum(blocks / np.sqrt((blocks**2).sum(axis=-1, keepdims=True) + softness**2), _CUT)
    blocks = blocks / np.sqrt((blocks**2).sum(axis=-1, keepdims=True) + softness**2)
    features[:] = blocks.reshape(n, -1)
