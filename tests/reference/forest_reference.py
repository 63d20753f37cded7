"""What the kernels of `perception.legs.forest_kernel` compute, in plain numpy."""

import numpy as np


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
