"""Kernel that finds the nearest of points that lie in a tree of boxes (see `nearest`)."""

import numpy as np

from ..view_kernel import kernel

LEAF = 8
"""Points in a box of the finest level."""
_TIE = 1e-10
"""Points whose squared distances differ by no more than this are told apart by the `KDTree` [m^2], of 1 m^2 or less; of
larger ones this share."""


@kernel
def find_nearest(queries, points, boxes, squares, nearest):
    """Write the squared distance to the nearest of `points` and its index, -1 where another is as near.

    Args:
        queries: (m, 2) [m].
        points: (n, 2) [m] in the order of `boxes`.
        boxes: (2 k, 4) of `_boxes`.
        squares: (m,) squared distances [m^2].
        nearest: (m,) indices.
    """
    leaves, count = np.uint64(len(boxes) // 2), np.uint64(len(points))
    waiting, distances = np.empty(64, dtype=np.uint64), np.empty(64)
    for q in range(len(queries)):
        x, y = queries[q, 0], queries[q, 1]
        best, limit, second, found = np.inf, np.inf, np.inf, np.uint64(0)
        node, depth = np.uint64(1), 0
        while True:
            if node >= leaves:
                first = (node - leaves) * np.uint64(LEAF)
                for k in range(first, min(first + np.uint64(LEAF), count)):
                    dx, dy = points[k, 0] - x, points[k, 1] - y
                    square = dx * dx + dy * dy
                    if square < best:
                        second, best, found = best, square, k
                        limit = best + _TIE * max(1.0, best)
                    elif square < second:
                        second = square
            else:
                near, far = node << np.uint64(1), (node << np.uint64(1)) | np.uint64(1)
                d_near, d_far = _to_box(x, y, boxes, near), _to_box(x, y, boxes, far)
                if d_far < d_near:
                    near, far, d_near, d_far = far, near, d_far, d_near
                if d_far <= limit:
                    waiting[depth], distances[depth] = far, d_far
                    depth += 1
                if d_near <= limit:
                    node = near
                    continue
            while depth > 0 and distances[depth - 1] > limit:
                depth -= 1
            if depth == 0:
                break
            depth -= 1
            node = waiting[depth]
        squares[q] = best
        nearest[q] = found if second > limit else -1


@kernel
def _to_box(x, y, boxes, box):
    """Return the squared distance from (x, y) to a box, 0 inside; never above that to a point in it, as rounded."""
    dx = max(boxes[box, 0] - x, x - boxes[box, 2], 0.0)
    dy = max(boxes[box, 1] - y, y - boxes[box, 3], 0.0)
    return dx * dx + dy * dy
