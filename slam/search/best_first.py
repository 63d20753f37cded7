"""Best-first search of the highest leaves of a pyramid, in numba: a block is opened once at most for all of them."""

import numpy as np

from ..view_kernel import kernel
from .kernels import child_sums, excluded, nearest

_RANKS = 1 << 30  # of a candidate: its squared distance from the window's centre in steps is below
_FIRST_ROWS = 64  # of top blocks that come to the heap at once, the highest; then four times as many, and so on


@kernel
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


@kernel
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


@kernel
def row_peaks(bounds):  # pragma: no cover
    """Return (n_theta, blocks) int32, the highest of each row of `bounds` (n_theta, blocks, blocks')."""
    n_theta, blocks, width = bounds.shape
    peaks, flat = np.empty((n_theta, blocks), dtype=np.int32), bounds.ravel()
    for k in range(n_theta):
        for a in range(blocks):
            highest, start = np.int32(-1), np.uintp((k * blocks + a) * width)
            for b in range(np.uintp(blocks)):
                highest = max(highest, flat[start + b])
            peaks[k, a] = highest
    return peaks


@kernel
def dive(levels, cells, bounds, peaks, side, sums):  # pragma: no cover
    """Return (highest bound, sum of the leaf found below it by taking the best child, blocks looked at)."""
    stride, blocks = 1 << (len(levels) - 1), bounds.shape[1]
    highest, row = np.int64(-1), 0
    for at in range(peaks.size):
        if peaks.flat[at] > highest:
            highest, row = np.int64(peaks.flat[at]), at
    k, i, j, looked = row // blocks, row % blocks * stride, 0, 0
    for b in range(blocks):
        if bounds[k, row % blocks, b] == highest:
            j = b * stride
            break
    total = highest
    for level in range(len(levels) - 2, -1, -1):
        size, total, at_i, at_j = 1 << level, np.int64(-1), i, j
        child_sums(levels[level], cells[k], i, j, size, sums)
        for child in range(4):
            ci, cj = at_i + (child >> 1) * size, at_j + (child & 1) * size
            if ci < side and cj < side:
                looked += 1
                if sums[child] > total:
                    total, i, j = sums[child], ci, cj
    return highest, total, looked


@kernel
def key_of(total, k, i, j, size, n_theta, side):  # pragma: no cover
    """Return the order of a block: by its sum, then nearness to the window's centre, then blocks before leaves."""
    rank = nearest(k, 1, n_theta // 2) + nearest(i, size, side // 2) + nearest(j, size, side // 2)
    return (np.int64(total) * _RANKS + (_RANKS - 1 - rank)) * 2 + (size > 1)


@kernel
def add_top_blocks(keys, items, size, bounds, peaks, low, high, stride, top_level, side):  # pragma: no cover
    """Return (keys, items, size): the heap with the top blocks of a bound in low .. high - 1, and room for more."""
    n_theta, blocks, _ = bounds.shape
    width = blocks * stride
    for k in range(n_theta):
        for a in range(blocks):
            if peaks[k, a] < low:
                continue
            if size + blocks + 4 > len(keys):
                keys, items = grown(keys, blocks + 4), grown(items, blocks + 4)
            for b in range(blocks):
                if low <= bounds[k, a, b] < high:
                    keys[size] = key_of(bounds[k, a, b], k, a * stride, b * stride, stride, n_theta, side)
                    items[size] = ((top_level * n_theta + k) * width + a * stride) * width + b * stride
                    rise(keys, items, size)
                    size += 1
    return keys, items, size


@kernel
def add_children(keys, items, size, sums, floor, block, n_theta, width, side):  # pragma: no cover
    """Return (keys, items, size, children of a block inside the window): the heap with those of at least `floor`.

    `block` is (level, k, i, j), `sums` (4,) its children's.
    """
    level, k, i, j = block
    if size + 4 > len(keys):
        keys, items = grown(keys, 4), grown(items, 4)
    half, inside = 1 << (level - 1), 0
    for child in range(4):
        ci, cj = i + (child >> 1) * half, j + (child & 1) * half
        if ci >= side or cj >= side:
            continue
        inside += 1
        if sums[child] >= floor:
            keys[size] = key_of(sums[child], k, ci, cj, half, n_theta, side)
            items[size] = (((level - 1) * n_theta + k) * width + ci) * width + cj
            rise(keys, items, size)
            size += 1
    return keys, items, size, inside


@kernel
def grown(values, least):  # pragma: no cover
    """Return `values` with room for as many again, `least` at least."""
    return np.concatenate((values, np.empty(max(len(values), least), dtype=values.dtype)))


@kernel
def best_leaves(levels, cells, bounds, side, maxima, reach, period, least, share):  # pragma: no cover
    """Return ((m, 4) int64 of (sum, k, i, j), blocks looked at): the best candidates, best first, each apart from those
    before it by more than `reach` = (headings, cells).

    None has a sum below `least`, nor below `share` of the first. Of equal sums the candidate nearest to the window's
    centre in steps is better, then the one of the lower (k, i, j). Top blocks come to the heap by and by, the highest
    first: most of them are never wanted.
    """
    top_level, n_theta, blocks = len(levels) - 1, bounds.shape[0], bounds.shape[1]
    stride = 1 << top_level
    found, taken, count = np.empty((maxima, 4), dtype=np.int64), np.empty((maxima, 3), dtype=np.int64), 0
    peaks, sums = row_peaks(bounds), np.empty(4, dtype=np.int64)
    # A leaf that is surely there leaves few of the blocks to be looked at.
    highest, total, looked = dive(levels, cells, bounds, peaks, side, sums)
    looked += n_theta * blocks * blocks
    if highest < least:
        return found[:0], looked
    floor, width = max(least, np.int64(total if maxima == 1 else np.ceil(share * total))), blocks * stride
    keys, items, size = np.empty(1024, dtype=np.int64), np.empty(1024, dtype=np.int64), 0
    heights, rows, low = np.sort(peaks.ravel()), _FIRST_ROWS, highest + 1  # all blocks from `low` on have come
    while count < maxima:
        while low > floor and (size == 0 or keys[0] >> 31 < low):
            high, low = low, max(floor, np.int64(heights[-rows])) if rows <= len(heights) else floor
            keys, items, size = add_top_blocks(keys, items, size, bounds, peaks, low, high, stride, top_level, side)
            rows *= 4
        if size == 0 or keys[0] >> 31 < floor:
            break
        total, item = keys[0] >> 31, items[0]
        size -= 1
        keys[0], items[0] = keys[size], items[size]
        sink(keys, items, size)
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
        child_sums(levels[level - 1], cells[k], i, j, 1 << (level - 1), sums)
        block = level, k, i, j
        keys, items, size, inside = add_children(keys, items, size, sums, floor, block, n_theta, width, side)
        looked += inside
    return found[:count], looked
