"""What the kernels of `perception.tracking.pairing` compute, in plain numpy."""

import numpy as np
from numpy.typing import NDArray
from tagalong.perception.tracking.pairing import Array, Pairs


def mutual_pairs_reference(spread: Array, limit: float) -> Pairs:
    """Return what `mutual_pairs` returns, in plain numpy."""
    if len(spread) == 0:
        return np.zeros((0, 2), dtype=np.intp)
    partner = spread.argmin(axis=1)
    first = np.arange(len(partner))
    real = (partner[partner] == first) & (first < partner) & (spread[first, partner] <= limit)
    return np.stack((first[real], partner[real]), axis=1)


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
