"""The nearest of many points of the plane, exactly as `scipy.spatial.KDTree` finds it, for many questions."""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from .nearest_kernel import LEAF, find_nearest

Array = NDArray[np.float64]


class NearestPoints:
    """Answers which of `points` (n, 2) is nearest, several times faster than the search tree it stands beside.

    The points are sorted along a space-filling curve (Morton 1966) and boxed by eights, pairs of boxes by larger boxes.
    Where two points are equally near, the tree is asked, so that answers are its answers.
    """

    def __init__(self, points: Array) -> None:
        self.tree = KDTree(points)
        self._order = np.argsort(_along_curve(points), kind="stable")
        self._sorted = points[self._order]
        self._boxes = _boxes(self._sorted)

    def query(self, points: Array) -> tuple[Array, NDArray[np.intp]]:
        """Return (m,) the distances from `points` (m, 2) to the nearest points, and (m,) which these are."""
        squares, nearest = np.empty(len(points)), np.empty(len(points), dtype=np.intp)
        find_nearest(points, self._sorted, self._boxes, squares, nearest)
        distances, unsure = np.sqrt(squares), np.flatnonzero(nearest < 0)
        nearest = self._order[nearest]
        if len(unsure):
            distances[unsure], nearest[unsure] = self.tree.query(points[unsure])
        return distances, nearest


def _along_curve(points: Array) -> NDArray[np.uint64]:
    """Return (n,) the places of `points` (n, 2) along the curve: the bits of x and y in turn."""
    low = points.min(axis=0)
    places = ((points - low) * (65535.0 / max(float((points - low).max()), 1e-9))).astype(np.uint64)
    for shift, mask in ((8, 0x00FF00FF), (4, 0x0F0F0F0F), (2, 0x33333333), (1, 0x55555555)):
        places = (places | (places << np.uint64(shift))) & np.uint64(mask)
    return places[:, 0] | (places[:, 1] << np.uint64(1))


def _boxes(points: Array) -> Array:
    """Return (2 m, 4) boxes (low x, low y, high x, high y): the m finest last, box k holds boxes 2 k and 2 k + 1."""
    leaves = 1 << max(0, int(np.ceil(np.log2(len(points) / LEAF))))
    filled = -(-len(points) // LEAF)
    firsts = np.arange(filled) * LEAF
    boxes = np.full((2 * leaves, 4), (np.inf, np.inf, -np.inf, -np.inf))
    boxes[leaves : leaves + filled, :2] = np.minimum.reduceat(points, firsts)
    boxes[leaves : leaves + filled, 2:] = np.maximum.reduceat(points, firsts)
    while leaves > 1:
        pairs = boxes[leaves : 2 * leaves].reshape(-1, 2, 4)
        leaves //= 2
        boxes[leaves : 2 * leaves, :2] = pairs[:, :, :2].min(axis=1)
        boxes[leaves : 2 * leaves, 2:] = pairs[:, :, 2:].max(axis=1)
    return boxes
