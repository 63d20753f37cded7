"""Global nearest neighbour: which detection belongs to which track (Ye 2021, section II.A; Munkres)."""

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment
from scipy.spatial.distance import cdist

Array = NDArray[np.float64]


def distances(tracks: Array, detections: Array) -> Array:
    """Return (n, m) Euclidean distances between positions (n, 2) and (m, 2)."""
    if len(tracks) == 0 or len(detections) == 0:
        return np.zeros((len(tracks), len(detections)))
    return np.asarray(cdist(tracks, detections), dtype=np.float64)


def assign(cost: Array, gate: float | Array) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the pairs (rows, columns) of least total cost, where leaving a row unmatched costs its `gate`.

    A pair costs at most the gate, so no match is stretched to make room for another; pairs at or beyond the gate are
    no pairs. Entries may be `inf`; `gate` is a number or one a row (n,).
    """
    limit = np.broadcast_to(np.asarray(gate, dtype=np.float64), len(cost))[:, None]
    near = cost < limit
    rows, columns = np.flatnonzero(near.any(axis=1)), np.flatnonzero(near.any(axis=0))
    if len(rows) == 0:
        return rows, columns
    gain = np.minimum(cost - limit, 0.0)[np.ix_(rows, columns)]
    i, j = linear_sum_assignment(gain)
    real = gain[i, j] < 0.0
    return rows[i[real]], columns[j[real]]
