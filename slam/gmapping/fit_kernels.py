"""Kernels that ask how far a map and a scan agree, and look for a pose where they do. Lengths are in cells.

A point near an occupied cell is explained; one in a cell that rays have crossed, with nothing occupied near it,
contradicts the map; where no ray has been yet the map says nothing about it.
"""

import numpy as np
from numba import njit

from .search_kernels import NEAR
from .tile_kernels import MASK, SHIFT, SIDE


@njit(cache=True, nogil=True)
def compare(x, y, theta, points, unseen, most, directory, counts, bits):
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
            row, shift = row & MASK, np.uint64(col & MASK)
            wide = (np.uint64(31) << shift) >> np.uint64(2)
            narrow = (np.uint64(7) << shift) >> np.uint64(1)
            beside, around = np.uint64(0), np.uint64(0)
            for r in range(max(row - NEAR, 0), min(row + NEAR + 1, SIDE)):
                word = np.uint64(bits[tile, np.uintp(r)])
                around |= word & wide
                if abs(r - row) <= 1:
                    beside |= word & narrow
            if beside != 0:
                continue
            if around != 0:
                against += 0.5
            elif counts[tile, np.uintp((row << SHIFT) | (col & MASK)), 1] == 0:
                against += unseen
                unknown += 1
            else:
                against += 1.0
    return against, unknown


@njit(cache=True, nogil=True)
def search_window(centre, reach, step, points, weight, unseen, enough, directory, counts, bits, pose):
    """Write into `pose` (3,) the best of the poses of a window, and return its value; -inf if none exceeds `enough`.

    The window has `reach` (3,) steps of `step` (3,) to each side of `centre` (3,), headings outside, from the middle
    out. A pose is worth -`weight` times the mean of what speaks against it (see `compare`), less half its squared
    distance from the centre, which counts 1 half way to the border of the window.
    """
    best, found = enough, False
    for h in range(2 * reach[2] + 1):
        k = (h + 1) // 2 * (1 - 2 * (h & 1))
        theta = centre[2] + k * step[2]
        far_k = (2.0 * k / max(reach[2], 1)) ** 2
        for v in range(2 * reach[1] + 1):
            j = (v + 1) // 2 * (1 - 2 * (v & 1))
            far_j = far_k + (2.0 * j / max(reach[1], 1)) ** 2
            for u in range(2 * reach[0] + 1):
                i = (u + 1) // 2 * (1 - 2 * (u & 1))
                far = far_j + (2.0 * i / max(reach[0], 1)) ** 2
                most = (-0.5 * far - best) * len(points) / weight
                if most <= 0.0:
                    continue
                x, y = centre[0] + i * step[0], centre[1] + j * step[1]
                against, _ = compare(x, y, theta, points, unseen, most, directory, counts, bits)
                if against < most:
                    best, found = -0.5 * far - weight * against / len(points), True
                    pose[0], pose[1], pose[2] = x, y, theta
    return best if found else -np.inf


@njit(cache=True, nogil=True)
def search_samples(prior, root, samples, points, weight, unseen, directory, counts, bits, pose):
    """Write into `pose` (3,) the best of the poses `prior + root @ sample`; values as in `search_window`."""
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
        against, _ = compare(x, y, theta, points, unseen, most, directory, counts, bits)
        if against < most:
            best = top - weight * against / len(points)
            pose[0], pose[1], pose[2] = x, y, theta
