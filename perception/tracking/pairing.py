"""Which two legs belong to one person, judged by how far apart they stay in the mean over a stride.

`spread` (n, n) is the length of the mean vector between two leg tracks [m] (`LegTracks.spread`).
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]
Pairs = NDArray[np.intp]


@njit(cache=True, nogil=True)
def mutual_pairs(spread: Array, limit: float) -> Pairs:
    """Return (k, 2) pairs, each the other's nearest by `spread` (n, n), infinite on the diagonal, at most `limit`."""
    count = len(spread)
    partner = np.empty(count, np.int64)
    for i in range(count):
        partner[i] = spread[i].argmin()
    pairs = np.empty((count // 2, 2), np.int64)
    found = 0
    for i in range(count):
        j = partner[i]
        if i < j and partner[j] == i and spread[i, j] <= limit:
            pairs[found, 0], pairs[found, 1] = i, j
            found += 1
    return pairs[:found]


def mutual_pairs_reference(spread: Array, limit: float) -> Pairs:
    """Return what `mutual_pairs` returns, in plain numpy."""
    if len(spread) == 0:
        return np.zeros((0, 2), dtype=np.intp)
    partner = spread.argmin(axis=1)
    first = np.arange(len(partner))
    real = (partner[partner] == first) & (first < partner) & (spread[first, partner] <= limit)
    return np.stack((first[real], partner[real]), axis=1)


@njit(cache=True, nogil=True)
def better_pairs(spread: Array, pairs: Pairs, owned_s: Array, lone: Pairs, margin: float) -> Pairs:
    """Return `pairs` (n, 2) after every exchange of a leg that narrows the pairs by more than `margin`.

    A person gives nobody's legs only for its newer leg, so the identity stays with the leg that had it first.

    Args:
        spread: (m, m) between all leg tracks.
        pairs: (n, 2) rows of the legs of each person.
        owned_s: (m,) time that a leg has been its person's [s].
        lone: (k,) rows of nobody's legs that may be taken.
        margin: By how much a pair must become narrower [m].
    """
    pairs, free = pairs.copy(), lone.copy()
    wide = np.empty(len(pairs), np.bool_)
    for i in range(len(pairs)):
        wide[i] = spread[pairs[i, 0], pairs[i, 1]] > margin
    for i in np.flatnonzero(wide):
        here = spread[pairs[i, 0], pairs[i, 1]]
        newer = 1 if owned_s[pairs[i, 1]] <= owned_s[pairs[i, 0]] else 0
        best, side, other, k = margin, -1, -1, -1
        for f in range(len(free)):
            gain = here - spread[pairs[i, 1 - newer], free[f]]
            if gain > margin and (gain, newer, -1, f) > (best, side, other, k):
                best, side, other, k = gain, newer, -1, f
        for j in range(len(pairs)):
            if j == i:
                continue
            before = here + spread[pairs[j, 0], pairs[j, 1]]
            for s in range(2):
                for t in range(2):
                    after = spread[pairs[i, 1 - s], pairs[j, t]]
                    gain = before - after - spread[pairs[j, 1 - t], pairs[i, s]] - margin
                    if gain > margin and (gain, s, j, t) > (best, side, other, k):
                        best, side, other, k = gain, s, j, t
        if side >= 0:
            given = pairs[i, side]
            if other < 0:
                pairs[i, side], free[k] = free[k], given
            else:
                pairs[i, side], pairs[other, k] = pairs[other, k], given
    return pairs


def better_pairs_reference(spread: Array, pairs: Pairs, owned_s: Array, lone: Pairs, margin: float) -> Pairs:
    """Return what `better_pairs` returns, in plain Python."""
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
