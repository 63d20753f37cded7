"""Kernels that look for a good start of the alignment among samples of the odometry's error. Lengths are in cells.

A sample's score is the share of the points that fall near an occupied cell, less its own improbability. It is read from
the bits of the tiles, five words a point; samples that can no longer win are left early, which changes no result.
"""

import numpy as np
from numba import njit

from .tile_kernels import MASK, SHIFT, SIDE

NEAR = 2  # cells; a point counts fully within one cell (either axis), half within NEAR; tiles end the sight


@njit(cache=True, nogil=True)
def farness(x, y, directory, bits):
    """Return 0 where an occupied cell is within one cell of (x, y), 1 within NEAR, else 2."""
    col, row = int(np.floor(x)), int(np.floor(y))
    if row < 0 or col < 0 or row >> SHIFT >= directory.shape[0] or col >> SHIFT >= directory.shape[1]:
        return 2
    tile = directory[row >> SHIFT, col >> SHIFT]
    if tile == 0:
        return 2
    row, shift = row & MASK, np.uint64(col & MASK)
    wide = np.uint32((np.uint64(31) << shift) >> np.uint64(2))
    narrow = np.uint32((np.uint64(7) << shift) >> np.uint64(1))
    beside, around = np.uint32(0), np.uint32(0)
    for r in range(max(row - NEAR, 0), min(row + NEAR + 1, SIDE)):
        around |= bits[tile, r] & wide
        if abs(r - row) <= 1:
            beside |= bits[tile, r] & narrow
    if beside != 0:
        return 0
    return 1 if around != 0 else 2


@njit(cache=True, nogil=True)
def search(prior, root, samples, points, weight, directory, bits, pose):
    """Write into `pose` (3,) the best of the poses `prior + root @ sample`.

    Args:
        prior: (3,) pose by odometry.
        root: (3, 3) lower Cholesky factor of its covariance.
        samples: (m, 3) standard normal draws.
        points: (n, 2) of the scan.
        weight: Log-likelihood that lies between no point and every point near an occupied cell.
        directory, bits: The map.
        pose: (3,) the result.
    """
    best = -np.inf
    for i in range(len(samples)):
        z0, z1, z2 = samples[i]
        x = prior[0] + root[0, 0] * z0
        y = prior[1] + root[1, 0] * z0 + root[1, 1] * z1
        theta = prior[2] + root[2, 0] * z0 + root[2, 1] * z1 + root[2, 2] * z2
        top = weight - 0.5 * (z0 * z0 + z1 * z1 + z2 * z2)
        cos, sin = np.cos(theta), np.sin(theta)
        missed, chance = 0, (top - best) * 2 * len(points) / weight  # more than this, and another sample is better
        for first in range(4):
            if missed >= chance:
                break
            for k in range(first, len(points), 4):
                px, py = points[k]
                missed += farness(x + cos * px - sin * py, y + sin * px + cos * py, directory, bits)
        value = top - weight * missed / (2 * max(len(points), 1))
        if missed < chance and value > best:
            best = value
            pose[0], pose[1], pose[2] = x, y, theta


@njit(cache=True, nogil=True)
def search_particles(start, stop, priors, roots, samples, points, weight, directory, bits, poses):
    """`search` for particles start..stop."""
    for p in range(start, stop):
        search(priors[p], roots[p], samples, points, weight, directory[p], bits, poses[p])
