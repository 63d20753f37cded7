"""Which two legs belong to one person, judged by how far apart they stay in the mean over a stride.

`spread` (n, n) is the length of the mean vector between two leg tracks [m] (`LegTracks.spread`).
"""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Pairs = NDArray[np.intp]


def mutual_pairs(spread: Array, limit: float) -> Pairs:
    """Return (k, 2) pairs that are each other's nearest by `spread` (n, n), at most `limit`."""
    spread = spread.copy()
    np.fill_diagonal(spread, np.inf)
    partner = spread.argmin(axis=1)
    first = np.arange(len(partner))
    real = (partner[partner] == first) & (first < partner) & (spread[first, partner] <= limit)
    return np.stack((first[real], partner[real]), axis=1)


def better_pairs(spread: Array, pairs: Pairs, owned_s: Array, lone: NDArray[np.intp], margin: float) -> Pairs:
    """Return `pairs` (n, 2) after every exchange of a leg that narrows the pairs by more than `margin`.

    A person gives nobody's legs only for its newer leg, so the identity stays with the leg that had it first.

    Args:
        spread: (m, m) between all leg tracks.
        pairs: (n, 2) rows of the legs of each person.
        owned_s: (m,) time that a leg has been its person's [s].
        lone: (k,) rows of nobody's legs that may be taken.
        margin: By how much a pair must become narrower [m].
    """
    pairs, free = pairs.copy(), [int(row) for row in lone]
    for i in np.flatnonzero(spread[pairs[:, 0], pairs[:, 1]] > margin):
        newer = int(owned_s[pairs[i, 1]] <= owned_s[pairs[i, 0]])
        gains = [(_gain_from_nobody(spread, pairs[i], newer, row), newer, -1, k) for k, row in enumerate(free)]
        gains += [
            (_gain_from_person(spread, pairs[i], side, pairs[j], s) - margin, side, int(j), s)
            for j in range(len(pairs))
            for side in (0, 1)
            for s in (0, 1)
            if j != i
        ]
        gain, side, j, k = max(gains, default=(0.0, 0, 0, 0))
        if gain > margin:
            given = int(pairs[i, side])
            if j < 0:
                pairs[i, side], free[k] = free[k], given
            else:
                pairs[i, side], pairs[j, k] = pairs[j, k], given
    return pairs


def _gain_from_nobody(spread: Array, pair: NDArray[np.intp], side: int, row: int) -> float:
    return float(spread[pair[0], pair[1]] - spread[pair[1 - side], row])


def _gain_from_person(spread: Array, pair: NDArray[np.intp], side: int, other: NDArray[np.intp], s: int) -> float:
    before = spread[pair[0], pair[1]] + spread[other[0], other[1]]
    return float(before - spread[pair[1 - side], other[s]] - spread[other[1 - s], pair[side]])
