"""Which two legs belong to one person, judged by how far apart they stay in the mean over a stride.

`spread` (n, n) is the length of the mean vector between two leg tracks [m] (`LegTracks.spread`).
"""

import numpy as np
from numpy.typing import NDArray

from ...slam.view_kernel import kernel

Array = NDArray[np.float64]
Pairs = NDArray[np.intp]


@kernel
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


@kernel
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
