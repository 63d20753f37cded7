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
    walls = _blocks_with_walls(field)
    side = _BLOCK + 2 * _RADIUS
    around, room, sums = np.empty((side, side), np.float32), np.empty(side, np.float32), np.empty(side)
    for a in range(walls.shape[0]):
        for b in range(walls.shape[1]):
            if walls[max(a - 1, 0) : a + 2, max(b - 1, 0) : b + 2].any():
                top, left = a * _BLOCK, b * _BLOCK
                first, start = max(top - _RADIUS, 0), max(left - _RADIUS, 0)
                part = field[first : top + _BLOCK + _RADIUS, start : left + _BLOCK + _RADIUS]
                around[:] = 0.0  # beyond the field
                up, aside = first - top + _RADIUS, start - left + _RADIUS
                around[up : up + part.shape[0], aside : aside + part.shape[1]] = part
                _blur_block(around, weights, room, sums, values[top : top + _BLOCK, left : left + _BLOCK])


@kernel
def _blocks_with_walls(field):  # type: ignore[no-untyped-def]
    """Return for each block whether any of its cells is not 0."""
    rows, cols = field.shape
    walls = np.zeros(((rows + _BLOCK - 1) // _BLOCK, (cols + _BLOCK - 1) // _BLOCK), np.bool_)
    for i in range(rows):
        here = walls[i // _BLOCK]
        for b in range(len(here)):
            if not here[b]:
                most = np.float32(0.0)
                for value in field[i, b * _BLOCK : (b + 1) * _BLOCK]:
                    most = max(most, value)
                here[b] = most > 0.0
    return walls


@kernel
def _blur_block(around, weights, room, sums, values):  # type: ignore[no-untyped-def]
    """Blur each row of a block, across rows into `room` and then along it into `values`.

    Args:
        around: The block and four cells on each side of it.
        weights: Of the Gaussian.
        room: (side of `around`,) for the numbers between, rounded as a filter rounds them.
        sums: (side of `around`,) likewise, not rounded.
        values: The scores.
    """
    rows, cols = values.shape
    for i in range(_RADIUS, _RADIUS + rows):
        here = around[i]
        for j in range(len(here)):
            sums[j] = np.float64(here[j]) * weights[_RADIUS]
        for k in range(_RADIUS, 0, -1):
            weight, above, below = weights[_RADIUS - k], around[i - k], around[i + k]
            for j in range(len(here)):
                sums[j] += (np.float64(above[j]) + np.float64(below[j])) * weight
        room[:] = sums
        for j in range(cols):
            sums[j] = np.float64(room[j + _RADIUS]) * weights[_RADIUS]
        for k in range(_RADIUS, 0, -1):
            weight = weights[_RADIUS - k]
            for j in range(cols):
                sums[j] += (np.float64(room[j + _RADIUS - k]) + np.float64(room[j + _RADIUS + k])) * weight
        for j in range(cols):
            worth = min(np.float32(_GAIN) * np.float32(sums[j]), np.float32(1.0)) * np.float32(255.0)
            values[i - _RADIUS, j] = np.uint8(np.rint(worth))
