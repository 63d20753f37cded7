"""Numba kernel of a random forest's vote, and the order of nodes in memory that it walks through."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...slam.view_kernel import kernel

NODE = np.dtype([("threshold", np.float32), ("child", np.uint32)])
"""A node in eight bytes, so that a step down a tree waits for memory once.

`child` is the index of its left child times 256, plus the feature that it asks for; the right child is the next node
after the left one. A leaf is its own child, with the threshold +inf: who has arrived stays.
"""
MOST_NODES = 1 << 24
MOST_FEATURES = 1 << 8
MOST_TREES, MOST_DEPTH = 10_000, 1000  # a cluster is asked at every level of every tree: 100 and 30 are usual
_FEATURE_BITS = np.uint32(8)
_FEATURE = np.uint32(MOST_FEATURES - 1)


class PackedForest(NamedTuple):
    """A forest in the order in which `vote` walks: all roots, then all their children, and so on.

    Attributes:
        nodes: (n,) of `NODE`, the roots first.
        share: (n,) the shares of leaves.
        depth: How many steps the longest walk has.
        trees: How many roots.
        odds: Prior odds by which the vote is weighed.
    """

    nodes: NDArray[Any]
    share: NDArray[np.float32]
    depth: int
    trees: int
    odds: float


def packed(
    feature: NDArray[Any], value: NDArray[np.float32], right: NDArray[Any], roots: NDArray[Any], odds: float
) -> PackedForest:
    """Return a forest as `vote` takes it.

    Args:
        feature: (n,) index that an inner node asks for; negative in a leaf.
        value: (n,) threshold of an inner node, share of legs in a leaf.
        right: (n,) right child of an inner node; the left one is the next node.
        roots: (t,) first node of each tree.
        odds: Prior odds.
    """
    levels, depth = [np.asarray(roots, dtype=np.int64)], 0
    while len(inner := levels[-1][feature[levels[-1]] >= 0]):
        levels.append(np.stack((inner + 1, right[inner]), axis=1).ravel())
        depth += 1
    order = np.concatenate(levels)
    leaf = feature[order] < 0
    child = np.arange(len(order))
    child[~leaf] = len(roots) + 2 * np.arange(len(order) - leaf.sum())
    nodes = np.empty(len(order), dtype=NODE)
    nodes["threshold"] = np.where(leaf, np.inf, value[order])
    nodes["child"] = child * MOST_FEATURES + np.where(leaf, 0, feature[order])
    share = np.where(leaf, value[order], 0.0).astype(np.float32)
    return PackedForest(nodes, share, depth, len(roots), float(odds))


@kernel
def vote(forest, rows, out):
    """Write the mean leaf value over all trees for each of `rows` (m, F) float32 into `out` (m,) float64.

    Rows at or below a threshold go left. No step depends on how a comparison turned out but for the sum of an index,
    and one step is taken down every tree in turn: the processor neither guesses nor waits for one tree's memory before
    it asks for the next.
    """
    nodes, share, trees = forest.nodes, forest.share, forest.trees
    at = np.empty(trees, np.uint32)
    for m in range(len(rows)):
        row = rows[m]
        for tree in range(trees):
            at[tree] = tree
        for _ in range(forest.depth):
            for tree in range(trees):
                node = nodes[at[tree]]
                above = np.uint32(row[node.child & _FEATURE] > node.threshold)
                at[tree] = (node.child >> _FEATURE_BITS) + above
        total = 0.0
        for tree in range(trees):
            total += share[at[tree]]
        out[m] = total / trees


@kernel
def _fits(feature, roots, columns):
    """Whether there are nodes and trees, no more of either than are allowed, and all trees begin and end inside."""
    count = len(feature)
    if count == 0 or len(roots) == 0 or count > MOST_NODES or columns > MOST_FEATURES or len(roots) > MOST_TREES:
        return False
    return roots.min() >= 0 and roots.max() < count and feature[count - 1] < 0


@kernel
def is_sound(feature, right, roots, columns):
    """Whether these are trees: each node inside the arrays and reached once; and `packed` and `vote` do them soon."""
    if not _fits(feature, roots, columns):
        return False
    count = len(feature)
    reached, depth = np.zeros(count, np.int64), np.zeros(count, np.int64)
    for root in roots:
        reached[root] += 1
    for node in range(count):
        if feature[node] < 0:
            continue
        if feature[node] >= columns or right[node] <= node or right[node] >= count:
            return False
        if depth[node] >= MOST_DEPTH:
            return False
        for child in (node + 1, np.int64(right[node])):
            reached[child] += 1
            depth[child] = depth[node] + 1
    return reached.min() == 1 and reached.max() == 1
