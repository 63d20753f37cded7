"""Global nearest neighbour: which detection belongs to which track (Ye 2021, section II.A; Munkres)."""

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from .track_kernels import distances, near_pairs

Array = NDArray[np.float64]

__all__ = ["assign", "distances"]


def assign(cost: Array, gate: float | Array) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the pairs (rows, columns) of least total cost, where leaving a row unmatched costs its `gate`.

    A pair costs at most the gate, so no match is stretched to make room for another; pairs at or beyond the gate are
    no pairs. Entries may be `inf`; `gate` is a number or one a row (n,).
    """
    limit = np.full(len(cost), gate, dtype=np.float64)
    rows, columns, alone = near_pairs(cost, limit)
    if alone:  # nobody wants what another wants: nothing to decide
        return rows, columns
    gain = np.minimum(cost - limit[:, None], 0.0)[np.ix_(rows, columns)]
    i, j = linear_sum_assignment(gain)
    real = gain[i, j] < 0.0
    return rows[i[real]], columns[j[real]]
