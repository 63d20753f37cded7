"""The blurred submap that is searched: only what lies near walls is computed, a few thousandths of a long view."""

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from ...view_kernel import kernel

_RADIUS = 4  # cells, where the Gaussian of one cell's width is cut off
_GAIN = 2.5  # a wall one cell wide stays about as high as it was
_BLOCK = 32  # cells of the side of a block
_WEIGHTS = np.exp(-0.5 * np.arange(-_RADIUS, _RADIUS + 1) ** 2.0)
_WEIGHTS = _WEIGHTS / _WEIGHTS.sum()


def blurred_scores(field: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Return (rows, cols) what a point in each cell of a submap is worth to a search; 255 is worth 1.

    To the byte `blurred_scores_reference`, as long as the outer four cells of `field` (rows, cols) are 0.
    """
    values = np.zeros(field.shape, np.uint8)
    _blur(field, _WEIGHTS, values)
    return values


def blurred_scores_reference(field: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Return what `blurred_scores` does, by a filter over all cells."""
    blurred = np.clip(_GAIN * gaussian_filter(field, 1.0), 0.0, 1.0)
    return np.rint(blurred * np.float32(255.0)).astype(np.uint8)


@kernel
def _blur(field, weights, values):  # type: ignore[no-untyped-def]
    """Write the scores of all blocks that have something in them or within four cells of them."""
    rows, cols = field.shape
    room = np.empty(_BLOCK + 2 * _RADIUS, np.float32)
    walls = _blocks_with_walls(field)
    for a in range(walls.shape[0]):
        for b in range(walls.shape[1]):
            if walls[max(a - 1, 0) : a + 2, max(b - 1, 0) : b + 2].any():
                first, left = a * _BLOCK, b * _BLOCK
                end, right = min(first + _BLOCK, rows), min(left + _BLOCK, cols)
                _blur_block(field, weights, values, room, first, left, end, right)


@kernel
def _blocks_with_walls(field):  # type: ignore[no-untyped-def]
    """Return for each block whether any of its cells is not 0."""
    rows, cols = field.shape
    walls = np.zeros(((rows + _BLOCK - 1) // _BLOCK, (cols + _BLOCK - 1) // _BLOCK), np.bool_)
    for i in range(rows):
        for b in range(walls.shape[1]):
            if not walls[i // _BLOCK, b]:
                for j in range(b * _BLOCK, min((b + 1) * _BLOCK, cols)):
                    if field[i, j] != 0.0:
                        walls[i // _BLOCK, b] = True
                        break
    return walls


@kernel
def _blur_block(field, weights, values, room, first, left, end, right):  # type: ignore[no-untyped-def]
    """Blur each row of a block, across rows into `room` and then along it into `values`; beyond the field all is 0."""
    rows, cols = field.shape
    for i in range(first, end):
        for j in range(left - _RADIUS, right + _RADIUS):
            total = 0.0
            if 0 <= j < cols:
                total = np.float64(field[i, j]) * weights[_RADIUS]
                for k in range(-_RADIUS, 0):
                    above = np.float64(field[i + k, j]) if i + k >= 0 else 0.0
                    below = np.float64(field[i - k, j]) if i - k < rows else 0.0
                    total += (above + below) * weights[_RADIUS + k]
            room[j - left + _RADIUS] = total
        for j in range(left, right):
            at = j - left + _RADIUS
            total = np.float64(room[at]) * weights[_RADIUS]
            for k in range(-_RADIUS, 0):
                total += (np.float64(room[at + k]) + np.float64(room[at - k])) * weights[_RADIUS + k]
            worth = min(np.float32(_GAIN) * np.float32(total), np.float32(1.0)) * np.float32(255.0)
            values[i, j] = np.uint8(np.rint(worth))
