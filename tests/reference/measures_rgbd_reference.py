"""What the kernels of `perception.rgbd.measures` compute, in plain numpy."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from tagalong.perception.rgbd.measures import _REACH, Array, Border


def count_borders_reference(
    depth: Array, label: NDArray[np.int32], step: float, counts: Array, inside: tuple[int, int, int]
) -> None:
    """Do what `count_borders` does, in numpy: shifted pictures, one step farther out each time."""
    row, column = np.indices(label.shape)
    for up, (down, across) in ((0, (0, -1)), (0, (0, 1)), (1, (-1, 0))):
        border = np.where(label >= 0, np.int64(Border.UNMEASURED), -1)
        undecided = label >= 0
        for away in range(1, _REACH + 1):
            beyond = _shifted(depth, away * down, away * across, np.inf) - depth
            i, j = row + away * down, column + away * across
            outside = (i < inside[0]) | (j < inside[1]) | (j >= inside[2])
            beyond[outside] = np.inf
            other = np.where(outside, -2, _shifted(label, away * down, away * across, -2))
            border[undecided & (other == label)] = -1
            undecided &= other != label
            for mine, kind in (
                (np.abs(beyond) <= step, Border.TOUCHING),
                (np.isfinite(beyond) & (beyond > step), Border.FREE),
                (beyond < -step, Border.HIDDEN),
                (other == -2, Border.CUT),
            ):
                border[undecided & mine] = kind
                undecided &= ~mine
        met = border >= 0
        for candidate, kind in zip(label[met].tolist(), border[met].tolist(), strict=True):
            counts[candidate, up, kind] += 1.0


def _shifted(picture: NDArray[Any], down: int, right: int, outside: float) -> NDArray[Any]:
    """Return (h, w) what `picture` has so many rows below and columns right of each pixel."""
    padded = np.pad(picture, _REACH, constant_values=outside)
    rows, cols = picture.shape
    return padded[_REACH + down : _REACH + down + rows, _REACH + right : _REACH + right + cols]
