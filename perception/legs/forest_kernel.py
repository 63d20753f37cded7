"""Numba kernel of a random forest's vote; `reference.py` says the same in numpy."""

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def vote(feature, value, right, roots, rows, out):
    """Write the mean leaf value over all trees for each of `rows` (m, F) float32 into `out` (m,) float64.

    A node is a leaf where `feature` is negative: `value` is its share of legs. Else `value` is the threshold: rows at
    or below it go to the next node, the others to node `right`.
    """
    out[:] = 0.0
    for root in roots:
        for m in range(len(rows)):
            node = root
            while feature[node] >= 0:
                if rows[m, feature[node]] <= value[node]:
                    node += 1
                else:
                    node = right[node]
            out[m] += value[node]
    out /= len(roots)


@njit(cache=True, nogil=True)
def is_sound(feature, right, roots, columns):
    """Whether every walk through the nodes ends in a leaf, inside the arrays."""
    count = len(feature)
    if count == 0 or len(roots) == 0 or roots.min() < 0 or roots.max() >= count or feature[count - 1] >= 0:
        return False
    for node in range(count):
        if feature[node] >= columns or (feature[node] >= 0 and (right[node] <= node or right[node] >= count)):
            return False
    return True


def vote_reference(feature, value, right, roots, rows):
    """Return what `vote` writes, in plain numpy."""
    total = np.zeros(len(rows))
    for root in roots:
        node = np.full(len(rows), root)
        inner = feature[node] >= 0
        while inner.any():
            below = rows[np.arange(len(rows)), np.maximum(feature[node], 0)] <= value[node]
            node = np.where(inner, np.where(below, node + 1, right[node]), node)
            inner = feature[node] >= 0
        total += value[node]
    return total / len(roots)
