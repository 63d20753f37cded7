"""Kernels that look for a good start of the alignment among samples of the odometry's error. Lengths are in cells.

A sample's score is the share of the points that fall near an occupied cell, less its own improbability. It is read from
the tiles' words of what is near, one a point; samples that can no longer win are left early, which changes no result.
"""

import numpy as np

from ..view_kernel import kernel
from .tile_kernels import MASK, SHIFT

NEAR = 2  # cells; a point counts fully within one cell (either axis), half within NEAR; tiles end the sight
_ONE, _HALF = np.uint64(1), np.uint64(32)


@kernel
def count_missed(x, y, theta, points, chance, directory, near):
    """Return what `points` (n, 2) miss, seen from a pose: 0 each where an occupied cell is within one cell, 1 within
    NEAR, else 2; the count may stop where it reaches `chance`."""
    cos, sin = np.cos(theta), np.sin(theta)
    missed = 0
    for first in range(4):
        if missed >= chance:
            break
        for k in range(first, len(points), 4):
            px, py = points[k, 0], points[k, 1]
            col, row = int(np.floor(x + cos * px - sin * py)), int(np.floor(y + sin * px + cos * py))
            missed += 2
            if row < 0 or col < 0 or row >> SHIFT >= directory.shape[0] or col >> SHIFT >= directory.shape[1]:
                continue
            tile = np.uintp(directory[np.uintp(row >> SHIFT), np.uintp(col >> SHIFT)])
            if tile == 0:
                continue
            word = near[tile, np.uintp(row & MASK)] >> np.uint64(col & MASK)
            missed -= np.int64((word & _ONE) + ((word >> _HALF) & _ONE))
    return missed


@kernel
def search(prior, root, samples, points, weight, directory, near, pose):
    """Write into `pose` (3,) the best of the poses `prior + root @ sample`.

    Args:
        prior: (3,) pose by odometry.
        root: (3, 3) lower Cholesky factor of its covariance.
        samples: (m, 3) standard normal draws.
        points: (n, 2) of the scan.
        weight: Log-likelihood that lies between no point and every point near an occupied cell.
        directory, near: The map.
        pose: (3,) the result.
    """
    best = -np.inf
    for i in range(len(samples)):
        z0, z1, z2 = samples[i, 0], samples[i, 1], samples[i, 2]
        x = prior[0] + root[0, 0] * z0
        y = prior[1] + root[1, 0] * z0 + root[1, 1] * z1
        theta = prior[2] + root[2, 0] * z0 + root[2, 1] * z1 + root[2, 2] * z2
        top = weight - 0.5 * (z0 * z0 + z1 * z1 + z2 * z2)
        chance = (top - best) * 2 * len(points) / weight  # more than this, and another sample is better
        missed = count_missed(x, y, theta, points, chance, directory, near)
        value = top - weight * missed / (2 * max(len(points), 1))
        if missed < chance and value > best:
            best = value
            pose[0], pose[1], pose[2] = x, y, theta


@kernel
def search_particles(start, stop, priors, roots, samples, points, weight, directory, near, poses):
    """`search` for particles start..stop."""
    for p in range(start, stop):
        search(priors[p], roots[p], samples, points, weight, directory[p], near, poses[p])
