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


def assign(cost: Array, gate: float) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the pairs (rows, columns) of least total cost, where leaving a pair unmatched costs `gate`.

    A pair costs at most `gate`, so no match is stretched to make room for another; pairs at or beyond the gate are
    no pairs. Entries may be `inf`.
    """
    near = cost < gate
    rows, columns = np.flatnonzero(near.any(axis=1)), np.flatnonzero(near.any(axis=0))
    if len(rows) == 0:
        return rows, columns
    inner = np.minimum(cost[np.ix_(rows, columns)], gate)
    i, j = linear_sum_assignment(inner)
    real = inner[i, j] < gate
    return rows[i[real]], columns[j[real]]
