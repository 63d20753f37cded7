"""Kernels that ask how far a map and a scan agree, and look for a pose where they do. Lengths are in cells.

A point near an occupied cell is explained; one in a cell that rays have crossed, with nothing occupied near it,
contradicts the map; where no ray has been yet the map says nothing about it.
"""

import numpy as np

from ..view_kernel import kernel
from .tile_kernels import MASK, SHIFT

NEAR = 2  # cells; see `compare`; tiles end the sight
_SHIFT, _ONE, _HALF = np.uintp(SHIFT), np.uint64(1), np.uint64(32)


@kernel
def compare(x, y, theta, points, unseen, most, directory, counts, near):
    """Return (contradicted, unknown) of `points` (n, 2) seen from a pose: what speaks against them, and how many lie
    where nothing is known.

    A point counts 0 against the pose where an occupied cell is within one cell, 1/2 within NEAR, `unseen` where nothing
    is known, else 1. The sum may stop where it reaches `most`.
    """
    cos, sin = np.cos(theta), np.sin(theta)
    against, unknown = 0.0, 0
    for first in range(4):
        if against >= most:
            break
        for k in range(first, len(points), 4):
            px, py = points[k, 0], points[k, 1]
            col, row = int(np.floor(x + cos * px - sin * py)), int(np.floor(y + sin * px + cos * py))
            tile = np.uintp(0)
            if row >= 0 and col >= 0 and row >> SHIFT < directory.shape[0] and col >> SHIFT < directory.shape[1]:
                tile = np.uintp(directory[np.uintp(row >> SHIFT), np.uintp(col >> SHIFT)])
            if tile == 0:
                against += unseen
                unknown += 1
                continue
            row, shift = np.uintp(row & MASK), np.uintp(col & MASK)
            word = near[tile, row] >> shift
            if word & _ONE:
                continue
            if (word >> _HALF) & _ONE:
                against += 0.5
            elif counts[tile, (row << _SHIFT) | shift, 1] == 0:
                against += unseen
                unknown += 1
            else:
                against += 1.0
    return against, unknown


@kernel
def draw_scores(row0, col0, side, unknown, near, directory, counts, bits, values):
    """Fill `values` (rows, cols) uint8 with what a point is worth in each square of `side` cells from (row0, col0) on.

    255 where a cell is occupied, at least `near` beside such a place, `unknown` where nothing is known, else 0.
    """
    rows, cols = directory.shape[0] << SHIFT, directory.shape[1] << SHIFT
    values[:] = unknown
    for i in range(values.shape[0]):
        for j in range(values.shape[1]):
            for r in range(row0 + i * side, row0 + (i + 1) * side):
                for c in range(col0 + j * side, col0 + (j + 1) * side):
                    if r < 0 or c < 0 or r >= rows or c >= cols:
                        continue
                    tile = np.uintp(directory[r >> SHIFT, c >> SHIFT])
                    if tile == 0:
                        continue
                    if (bits[tile, r & MASK] >> np.uint32(c & MASK)) & np.uint32(1):
                        values[i, j] = 255
                    elif values[i, j] == unknown and counts[tile, ((r & MASK) << SHIFT) | (c & MASK), 1] > 0:
                        values[i, j] = 0
    _widen(values, near)


@kernel
def _widen(values, near):
    """Let all beside a square of 255 be worth `near` at least; the outermost squares have no say."""
    for i in range(1, values.shape[0] - 1):
        for j in range(1, values.shape[1] - 1):
            if values[i, j] == 255:
                for r in range(i - 1, i + 2):
                    for c in range(j - 1, j + 2):
                        values[r, c] = max(values[r, c], near)


@kernel
def search_samples(prior, root, samples, points, weight, unseen, directory, counts, near, pose):
    """Write into `pose` (3,) the best of the poses `prior + root @ sample`.

    A pose is worth -`weight` times the mean of what speaks against it (see `compare`), less half the square of its
    sample, a standard normal draw.
    """
    best = -np.inf
    for i in range(len(samples)):
        z0, z1, z2 = samples[i, 0], samples[i, 1], samples[i, 2]
        x = prior[0] + root[0, 0] * z0
        y = prior[1] + root[1, 0] * z0 + root[1, 1] * z1
        theta = prior[2] + root[2, 0] * z0 + root[2, 1] * z1 + root[2, 2] * z2
        top = -0.5 * (z0 * z0 + z1 * z1 + z2 * z2)
        most = (top - best) * len(points) / weight
        if most <= 0.0:
            continue
        against, _ = compare(x, y, theta, points, unseen, most, directory, counts, near)
        if against < most:
            best = top - weight * against / len(points)
            pose[0], pose[1], pose[2] = x, y, theta
