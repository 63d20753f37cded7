"""Kernel that thins the points of a scan."""

import numpy as np

from ..view_kernel import kernel

_SPREAD = np.uint64(0x9E3779B97F4A7C15)  # odd, 2**64 over the golden ratio: neighbours fall far apart (Knuth)
_ONE = np.uint64(1)


@kernel
def first_of_squares(points, side):
    """Return the first of `points` (n, 2) in each square of `side`, in their order.

    The squares that were met stand in a table of twice as many places, each where its number, multiplied, points to, or
    in the next free one.
    """
    bits = np.uint64(4)
    while (_ONE << bits) < np.uint64(2 * len(points)):
        bits += _ONE
    table, last = np.full(_ONE << bits, -1), (_ONE << bits) - _ONE
    squares, kept, count = np.empty((len(points), 2)), np.empty(points.shape), 0
    for k in range(len(points)):
        x, y = np.floor(points[k, 0] / side), np.floor(points[k, 1] / side)
        key = (np.uint64(np.int64(x)) << np.uint64(32)) + np.uint64(np.int64(y))
        place = (key * _SPREAD) >> (np.uint64(64) - bits)
        while table[place] >= 0 and (squares[table[place], 0] != x or squares[table[place], 1] != y):
            place = (place + _ONE) & last
        if table[place] < 0:
            table[place] = count
            squares[count, 0], squares[count, 1] = x, y
            kept[count, 0], kept[count, 1] = points[k, 0], points[k, 1]
            count += 1
    return kept[:count]
