"""Which two legs belong to one person, judged by how far apart they stay in the mean over a stride.

`spread` (n, n) is the length of the mean vector between two leg tracks [m] (`LegTracks.spread`).
"""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Pairs = NDArray[np.intp]


def mutual_pairs(spread: Array, able: NDArray[np.bool_], limit: float) -> Pairs:
    """Return (k, 2) pairs that are each other's nearest by `spread` (n, n), at most `limit`, both `able` (n,).

    Legs that are not able take part in the question who is nearest: a leg waits for its partner.
    """
    spread = spread.copy()
    np.fill_diagonal(spread, np.inf)
    partner = spread.argmin(axis=1)
    first = np.arange(len(partner))
    real = (partner[partner] == first) & (first < partner) & able & able[partner] & (spread[first, partner] <= limit)
    return np.stack((first[real], partner[real]), axis=1)


def better_pairs(spread: Array, pairs: Pairs, lone: NDArray[np.intp], margin: float) -> Pairs:
    """Return `pairs` (n, 2) after every exchange of a leg that lowers the spread by more than `margin` each.

    Args:
        spread: (m, m) between all leg tracks.
        pairs: (n, 2) rows of the legs of each person.
        lone: (k,) rows of nobody's legs that may be taken.
        margin: By how much a pair must become narrower [m].
    """
    pairs = pairs.copy()
    free = [int(row) for row in lone]
    for i in np.flatnonzero(spread[pairs[:, 0], pairs[:, 1]] > margin):
        best, now = None, spread[pairs[i, 0], pairs[i, 1]]
        for side in (0, 1):
            kept = pairs[i, 1 - side]
            others = [(row, -1, 0) for row in free] + [
                (int(pairs[j, s]), j, s) for j in range(len(pairs)) if j != i for s in (0, 1)
            ]
            for row, j, s in others:
                gain = now - spread[kept, row]
                if j >= 0:  # the other person gets the leg that this one gives away
                    gain += spread[pairs[j, 0], pairs[j, 1]] - spread[pairs[j, 1 - s], pairs[i, side]] - margin
                if gain > margin and (best is None or gain > best[0]):
                    best = gain, side, row, j, s
        if best is not None:
            _, side, row, j, s = best
            if j >= 0:
                pairs[j, s] = pairs[i, side]
            else:
                free[free.index(row)] = int(pairs[i, side])
            pairs[i, side] = row
    return pairs
