"""What the kernels of `perception.nearness_kernel` compute, in plain numpy."""

import numpy as np
from numpy.typing import NDArray


def near_any_reference(points: NDArray[np.float64], others: NDArray[np.float64], distance: float) -> NDArray[np.bool_]:
    """Return what `near_any` returns, in plain numpy."""
    near = np.zeros(len(points), dtype=bool)
    for x, y in others:
        near |= (points[:, 0] - x) ** 2 + (points[:, 1] - y) ** 2 <= distance**2
    return near
