"""What kernels of the tracker do, in plain numpy and scipy; the tests compare them."""

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment
from scipy.spatial.distance import cdist

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Rows = NDArray[np.intp]


def assign_reference(cost: Array, gate: float | Array) -> tuple[Rows, Rows]:
    """Return the pairs of least total cost, where leaving a row unmatched costs its `gate`."""
    limit = np.full(len(cost), gate, dtype=np.float64)
    rows, columns = np.flatnonzero((cost < limit[:, None]).any(axis=1)), np.flatnonzero((cost < limit[:, None]).any(0))
    gain = np.minimum(cost - limit[:, None], 0.0)[np.ix_(rows, columns)]
    i, j = linear_sum_assignment(gain)
    real = gain[i, j] < 0.0
    return rows[i[real]], columns[j[real]]


class PlainGrid:
    """The rules of `LocalGrid`, cell by cell in a dictionary."""

    def __init__(self, resolution: float, still_s: float, forget_s: float) -> None:
        self.resolution, self.still_s, self.forget_s = resolution, still_s, forget_s
        self.cells: dict[tuple[int, int], tuple[float, float]] = {}

    def mark(self, points: Array, time_s: float, dt: float) -> None:
        """Add `dt` seconds of `points` (k, 2)."""
        for x, y in {tuple(cell) for cell in np.floor(points / self.resolution).astype(int).tolist()}:
            self.cells[x, y] = (self.stood_s((x, y), time_s) + dt, time_s)

    def stood_s(self, cell: tuple[int, int], time_s: float) -> float:
        """Return for how long something has stood in a `cell`."""
        stood_s, seen_s = self.cells.get(cell, (0.0, time_s))
        return stood_s if time_s - seen_s <= self.forget_s else 0.0

    def is_free(self, points: Array, time_s: float) -> Mask:
        """Return (n,) whether the cells of `points` (n, 2) and those around are free."""
        around = [(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1)]
        cells = np.floor(points / self.resolution).astype(int).tolist()
        return np.array(
            [max(self.stood_s((x + i, y + j), time_s) for i, j in around) < self.still_s for x, y in cells], dtype=bool
        )


def points_of_things(
    points: Array,
    start: NDArray[np.int64],
    end: NDArray[np.int64],
    thing: NDArray[np.bool_],
    humans: Array,
    zeta: float,
) -> Array:
    """Return (j, 2) those of `points` (k, 2) in the clusters `thing` (m,), farther than `zeta` from `humans` (h, 2)."""
    edges = np.zeros(len(points) + 1, dtype=np.int64)
    np.add.at(edges, start[thing], 1)
    np.subtract.at(edges, end[thing], 1)
    chosen = points[np.cumsum(edges[:-1]) > 0]
    return chosen[cdist(humans, chosen).min(axis=0, initial=np.inf) > zeta] if len(humans) else chosen
