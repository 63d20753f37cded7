"""Best-first search of the highest leaves of a pyramid, in numba: a block is opened once at most for all of them."""

import numba
import numpy as np

from .kernels import block_sum, excluded, nearest

_RANKS = 1 << 30  # of a candidate: its squared distance from the window's centre in steps is below


@numba.njit(cache=True, nogil=True)
def sink(keys, items, size):  # pragma: no cover
    """Move the heap's first entry down to its place: high keys come first, of equal ones the low item."""
    key, item, place = keys[0], items[0], 0
    while True:
        child = 2 * place + 1
        if child >= size:
            break
        other = child + 1
        if other < size and (keys[other] > keys[child] or (keys[other] == keys[child] and items[other] < items[child])):
            child = other
        if keys[child] < key or (keys[child] == key and items[child] >= item):
            break
        keys[place], items[place] = keys[child], items[child]
        place = child
    keys[place], items[place] = key, item


@numba.njit(cache=True, nogil=True)
def rise(keys, items, place):  # pragma: no cover
    """Move the heap's entry at `place` up to its place."""
    key, item = keys[place], items[place]
    while place > 0:
        parent = (place - 1) >> 1
        if keys[parent] > key or (keys[parent] == key and items[parent] <= item):
            break
        keys[place], items[place] = keys[parent], items[parent]
        place = parent
    keys[place], items[place] = key, item


@numba.njit(cache=True, nogil=True)
def dive(levels, cells, bounds, side):  # pragma: no cover
    """Return (highest bound, sum of the leaf found below it by taking the best child, blocks looked at)."""
    stride, blocks = 1 << (len(levels) - 1), bounds.shape[1]
    highest, k, i, j, looked = np.int64(-1), 0, 0, 0, 0
    for heading in range(len(bounds)):
        for a in range(blocks):
            for b in range(blocks):
                if bounds[heading, a, b] > highest:
                    highest, k, i, j = np.int64(bounds[heading, a, b]), heading, a * stride, b * stride
    total = highest
    for level in range(len(levels) - 2, -1, -1):
        size, total, at_i, at_j = 1 << level, np.int64(-1), i, j
        for child in range(4):
            ci, cj = at_i + (child >> 1) * size, at_j + (child & 1) * size
            if ci < side and cj < side:
                value = block_sum(levels[level], cells[k], ci, cj)
                looked += 1
                if value > total:
                    total, i, j = value, ci, cj
    return highest, total, looked


@numba.njit(cache=True, nogil=True)
def key_of(total, k, i, j, size, n_theta, side):  # pragma: no cover
    """Return the order of a block: by its sum, then nearness to the window's centre, then blocks before leaves."""
    rank = nearest(k, 1, n_theta // 2) + nearest(i, size, side // 2) + nearest(j, size, side // 2)
    return (np.int64(total) * _RANKS + (_RANKS - 1 - rank)) * 2 + (size > 1)


@numba.njit(cache=True, nogil=True)
def top_heap(bounds, floor, stride, top_level, side):  # pragma: no cover
    """Return (keys, items, size): the heap of the top blocks whose bound is at least `floor`, with room for more."""
    n_theta, blocks, _ = bounds.shape
    width, size = blocks * stride, 0
    room = np.count_nonzero(bounds >= floor) + 1024
    keys, items = np.empty(room, dtype=np.int64), np.empty(room, dtype=np.int64)
    for k in range(n_theta):
        for a in range(blocks):
            for b in range(blocks):
                if bounds[k, a, b] >= floor:
                    keys[size] = key_of(bounds[k, a, b], k, a * stride, b * stride, stride, n_theta, side)
                    items[size] = ((top_level * n_theta + k) * width + a * stride) * width + b * stride
                    rise(keys, items, size)
                    size += 1
    return keys, items, size


@numba.njit(cache=True, nogil=True)
def best_leaves(levels, cells, bounds, side, maxima, reach, period, least, share):  # pragma: no cover
    """Return ((m, 4) int64 of (sum, k, i, j), blocks looked at): the best candidates, best first, each apart from those
    before it by more than `reach` = (headings, cells).

    None has a sum below `least`, nor below `share` of the first. Of equal sums the candidate nearest to the window's
    centre in steps is better, then the one of the lower (k, i, j).
    """
    stride, n_theta, blocks = 1 << (len(levels) - 1), bounds.shape[0], bounds.shape[1]
    found, taken, count = np.empty((maxima, 4), dtype=np.int64), np.empty((maxima, 3), dtype=np.int64), 0
    # A leaf that is surely there leaves few of the blocks to be looked at.
    highest, total, looked = dive(levels, cells, bounds, side)
    looked += n_theta * blocks * blocks
    if highest < least:
        return found[:0], looked
    floor, width = max(least, np.int64(total if maxima == 1 else np.ceil(share * total))), blocks * stride
    keys, items, size = top_heap(bounds, floor, stride, len(levels) - 1, side)
    while size > 0 and count < maxima:
        key, item = keys[0], items[0]
        size -= 1
        keys[0], items[0] = keys[size], items[size]
        sink(keys, items, size)
        total = key >> 31
        if total < floor:
            break
        j, i, k = item % width, item // width % width, item // (width * width) % n_theta
        level = item // (width * width) // n_theta
        if excluded(k, i, j, 1 << level, taken[:count], reach, period):
            continue
        if level == 0:
            found[count, 0], found[count, 1], found[count, 2], found[count, 3] = total, k, i, j
            taken[count] = found[count, 1:]
            count += 1
            floor = max(floor, np.int64(np.ceil(share * found[0, 0])))
            continue
        if size + 4 > len(keys):
            keys, items = np.concatenate((keys, np.empty_like(keys))), np.concatenate((items, np.empty_like(items)))
        half = 1 << (level - 1)
        for child in range(4):
            ci, cj = i + (child >> 1) * half, j + (child & 1) * half
            if ci >= side or cj >= side:
                continue
            total = block_sum(levels[level - 1], cells[k], ci, cj)
            looked += 1
            if total >= floor:
                keys[size] = key_of(total, k, ci, cj, half, n_theta, side)
                items[size] = (((level - 1) * n_theta + k) * width + ci) * width + cj
                rise(keys, items, size)
                size += 1
    return found[:count], looked
