"""Kernels that write rays into tiles. All lengths are in cells, relative to the corner of the directory.

A tile is a square of SIDE x SIDE cells. Tile 0 is the empty one, shared by all, never written. Arrays of T tiles:
    counts (T, SIDE*SIDE, 2) uint16: hits, visits (hits included)
    means (T, SIDE*SIDE, 2) float32: mean hit point, from the lower corner of its cell
    bits (T, SIDE) uint32: bit c of word r is set where cell (r, c) is occupied
    near (T, SIDE) uint64: bit c of word r is set where an occupied cell of the tile is within one cell (either axis) of
        cell (r, c); bit 32 + c where one is within two
A directory (rows, cols) int32 names the tile of each place.
"""

import numpy as np

from ..rays import ray_start, ray_step
from ..view_kernel import kernel

SIDE = 32
SHIFT = 5
MASK = SIDE - 1
_MOST = np.uint16(65535)
_ONE, _TWO = np.uint32(1), np.uint32(2)
_SHIFT, _MASK = np.uintp(SHIFT), np.uintp(MASK)  # unsigned: numba asks of no index whether it is below zero


@kernel
def mark_tiles(x0, y0, ends, needed):
    """Set `needed` (rows, cols) where a ray from (x0, y0) to one of `ends` (n, 2) crosses a tile."""
    for k in range(len(ends)):
        _mark_ray(x0 / SIDE, y0 / SIDE, ends[k, 0] / SIDE, ends[k, 1] / SIDE, needed)


@kernel
def _mark_ray(x0, y0, x1, y1, needed):
    row, col, row_step, col_step, next_y, next_x, y_stride, x_stride, steps = ray_start(x0, y0, x1, y1)
    for _ in range(steps):
        needed[row, col] = True
        row, col, next_y, next_x = ray_step(row, col, row_step, col_step, next_y, next_x, y_stride, x_stride)
    needed[row, col] = True


@kernel
def draw_near(needed, directory, bits, near):
    """Write the words of `near` of the `needed` (rows, cols) tiles anew."""
    for i in range(needed.shape[0]):
        for j in range(needed.shape[1]):
            if not needed[i, j]:
                continue
            tile = directory[i, j]
            beside, around = np.zeros(SIDE + 4, dtype=np.uint32), np.zeros(SIDE + 4, dtype=np.uint32)
            for r in range(SIDE):
                word = bits[tile, r]
                beside[r + 2] = word | (word << _ONE) | (word >> _ONE)
                around[r + 2] = beside[r + 2] | (word << _TWO) | (word >> _TWO)
            for r in range(SIDE):
                one = np.uint64(beside[r + 1] | beside[r + 2] | beside[r + 3])
                two = around[r] | around[r + 1] | around[r + 2] | around[r + 3] | around[r + 4]
                near[tile, r] = one | (np.uint64(two) << np.uint64(SIDE))


@kernel
def write_rays(x0, y0, ends, is_hit, margin, fullness, directory, counts, means, bits):
    """Count a visit of every cell between (x0, y0) and each end; where `is_hit`, a hit in the cell of the end.

    The last share `margin` of a ray that hit something is not counted: how far it went is not known so well.
    """
    visit_cells(x0, y0, ends, is_hit, margin, fullness, directory, counts, bits)
    count_hits(ends, is_hit, fullness, directory, counts, means, bits)


@kernel
def visit_cells(x0, y0, ends, is_hit, margin, fullness, directory, counts, bits):
    """Visit the cells of each ray, its last one excluded (Amanatides and Woo 1987)."""
    for k in range(len(ends)):
        share = 1.0 - margin if is_hit[k] else 1.0
        x1, y1 = x0 + share * (ends[k, 0] - x0), y0 + share * (ends[k, 1] - y0)
        row, col, row_step, col_step, next_y, next_x, y_stride, x_stride, steps = ray_start(x0, y0, x1, y1)
        for _ in range(steps):
            r, c = np.uintp(row), np.uintp(col)
            tile = np.uintp(directory[r >> _SHIFT, c >> _SHIFT])
            cell = ((r & _MASK) << _SHIFT) | (c & _MASK)
            visits = counts[tile, cell, 1]
            if tile != 0 and visits != _MOST:
                counts[tile, cell, 1] = visits + np.uint16(1)
                hits = counts[tile, cell, 0]
                if hits != 0 and hits <= fullness * (visits + 1):
                    bits[tile, r & _MASK] &= ~(_ONE << np.uint32(c & _MASK))
            row, col, next_y, next_x = ray_step(row, col, row_step, col_step, next_y, next_x, y_stride, x_stride)


@kernel
def count_hits(ends, is_hit, fullness, directory, counts, means, bits):
    """Count a hit, and a visit, in the cell of each end that `is_hit`."""
    for k in range(len(ends)):
        if not is_hit[k]:
            continue
        x, y = ends[k, 0], ends[k, 1]
        col, row = int(np.floor(x)), int(np.floor(y))
        r, c = np.uintp(row), np.uintp(col)
        tile = np.uintp(directory[r >> _SHIFT, c >> _SHIFT])
        cell = ((r & _MASK) << _SHIFT) | (c & _MASK)
        if tile == 0 or counts[tile, cell, 1] == _MOST:
            continue
        counts[tile, cell, 0] += np.uint16(1)
        counts[tile, cell, 1] += np.uint16(1)
        hits = counts[tile, cell, 0]
        means[tile, cell, 0] += (x - col - means[tile, cell, 0]) / hits
        means[tile, cell, 1] += (y - row - means[tile, cell, 1]) / hits
        if hits > fullness * counts[tile, cell, 1]:
            bits[tile, r & _MASK] |= _ONE << np.uint32(c & _MASK)


@kernel
def mark_particles(start, stop, origins, ends, needed):
    """`mark_tiles` for particles start..stop."""
    for p in range(start, stop):
        mark_tiles(origins[p, 0], origins[p, 1], ends[p], needed[p])


@kernel
def write_particles(start, stop, origins, ends, is_hit, margin, fullness, needed, directory, counts, means, bits, near):
    """`write_rays` for particles start..stop, whose `needed` tiles are theirs alone."""
    for p in range(start, stop):
        write_rays(origins[p, 0], origins[p, 1], ends[p], is_hit, margin, fullness, directory[p], counts, means, bits)
        draw_near(needed[p], directory[p], bits, near)


@kernel
def own_tiles(needed, directory, references, free, free_count, used, counts, means, bits, near):
    """Give each particle a tile of its own at every needed place; return how many of `free` are left.

    A missing tile is taken empty from the end of `free`; one shared with another particle is copied first.
    """
    for p in range(directory.shape[0]):
        for r in range(directory.shape[1]):
            for c in range(directory.shape[2]):
                tile = directory[p, r, c]
                if not needed[p, r, c] or (tile != 0 and references[tile] == 1):
                    continue
                free_count -= 1
                new = free[free_count]
                if tile != 0 or used[new]:  # else it is as empty
                    counts[new] = counts[tile]
                    means[new] = means[tile]
                    bits[new] = bits[tile]
                    near[new] = near[tile]
                used[new] = True
                references[tile] -= 1
                references[new] = 1
                directory[p, r, c] = new
    return free_count
