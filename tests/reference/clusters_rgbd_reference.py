"""What the kernels of `perception.rgbd.clusters` compute, in plain numpy."""

import numpy as np
from numpy.typing import NDArray
from tagalong.perception.rgbd.clusters import Array


def connect_reference(
    points: Array, chosen: NDArray[np.bool_], gap: float, reach: int, label: NDArray[np.int32]
) -> int:
    """Do what `connect` does for a gap that does not grow, by comparing all pairs of pixels."""
    label[:] = -1
    rows, cols = np.nonzero(chosen)
    apart = np.maximum(np.abs(rows[:, None] - rows), np.abs(cols[:, None] - cols))
    where = points[rows, cols]
    linked = (apart <= reach) & (np.linalg.norm(where[:, None] - where, axis=-1) < gap)
    found = 0
    for start in range(len(rows)):
        if label[rows[start], cols[start]] >= 0:
            continue
        piece = np.zeros(len(rows), dtype=bool)
        piece[start] = True
        while True:
            wider = piece | linked[piece].any(axis=0)
            if (wider == piece).all():
                break
            piece = wider
        label[rows[piece], cols[piece]] = found
        found += 1
    return found
