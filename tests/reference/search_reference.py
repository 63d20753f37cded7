"""The plain numpy twin of `lanes.py`."""

import numpy as np
from numpy.typing import NDArray
from tagalong.slam.search.lanes import LANES


def add_lanes_reference(
    sums: NDArray[np.uint16], at: int, values: NDArray[np.uint8], starts: NDArray[np.int64], count: int, offset: int
) -> None:
    """Do what `add_lanes` does."""
    for start in starts[:count] + offset:
        sums[at : at + LANES] += values[start : start + LANES]
