"""Numba kernel of a random forest's vote; `reference.py` says the same in numpy."""

import numpy as np
from numba import njit

NODE = np.dtype([("value", np.float32), ("right", np.uint16), ("feature", np.int16)])
"""A node in eight bytes, so that a step down a tree waits for memory once: `right` counts nodes from this one."""


def packed(feature, value, right):
    """Return (n,) of `NODE` from the arrays of a forest; a tree must have fewer than 65536 nodes."""
    nodes = np.empty(len(feature), dtype=NODE)
    nodes["value"], nodes["feature"] = value, feature
    nodes["right"] = np.where(feature >= 0, right - np.arange(len(feature)), 0)
    return nodes


@njit(cache=True, nogil=True)
def vote(nodes, roots, rows, out):
    """Write the mean leaf value over all trees for each of `rows` (m, F) float32 into `out` (m,) float64.

    A node is a leaf where `feature` is negative: `value` is its share of legs. Else `value` is the threshold: rows at
    or below it go to the next node, the others to node `right`.
    """
    walking = np.empty(len(roots), np.int64)
    at = np.empty(len(roots), np.int64)
    for m in range(len(rows)):
        at[:] = roots
        walking[:] = np.arange(len(roots))
        count = len(roots)
        while count > 0:  # one step down every tree in turn: their waits for memory overlap
            still = 0
            for i in range(count):
                tree = walking[i]
                node = nodes[at[tree]]
                if node.feature >= 0:
                    at[tree] += 1 if rows[m, node.feature] <= node.value else np.int64(node.right)
                    walking[still] = tree
                    still += 1
            count = still
        total = 0.0
        for tree in range(len(roots)):
            total += nodes[at[tree]].value
        out[m] = total / len(roots)


@njit(cache=True, nogil=True)
def is_sound(feature, right, roots, columns):
    """Whether every walk through the nodes ends in a leaf, inside the arrays."""
    count = len(feature)
    if count == 0 or len(roots) == 0 or roots.min() < 0 or roots.max() >= count or feature[count - 1] >= 0:
        return False
    for node in range(count):
        if feature[node] < 0:
            continue
        if feature[node] >= columns or not 0 < right[node] - node < 65536 or right[node] >= count:
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
