"""Which points are near to any of some others."""

import numpy as np
from numpy.typing import NDArray

from ..slam.view_kernel import kernel


@kernel
def near_any(points: NDArray[np.float64], others: NDArray[np.float64], distance: float) -> NDArray[np.bool_]:
    """Return (n,) whether `points` (n, 2) are within `distance` of any of `others` (k, 2); NaN is near to nothing."""
    near = np.zeros(len(points), dtype=np.bool_)
    if len(others) == 0:
        return near
    for i in range(len(points)):
        for k in range(len(others)):
            dx, dy = points[i, 0] - others[k, 0], points[i, 1] - others[k, 1]
            if dx * dx + dy * dy <= distance * distance:
                near[i] = True
                break
    return near
