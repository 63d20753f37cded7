"""Global nearest neighbour: which detection belongs to which track (Ye 2021, section II.A; Munkres)."""

import numpy as np
from numpy.typing import NDArray

from .assignment import assigned
from .geometry_kernels import distances

Array = NDArray[np.float64]

__all__ = ["assign", "distances"]


def assign(cost: Array, gate: float | Array) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the pairs (rows, columns) of least total cost, where leaving a row unmatched costs its `gate`.

    A pair costs at most the gate, so no match is stretched to make room for another; pairs at or beyond the gate are
    no pairs. Entries may be `inf`; `gate` is a number or one a row (n,).
    """
    return assigned(np.ascontiguousarray(cost, dtype=np.float64), np.full(len(cost), gate, dtype=np.float64))
