"""The posterior of `round_centres`, compiled."""

import math

import numpy as np

from ..view_kernel import kernel


@kernel
def _fit(ranges, bearings, label, m, beta, distance, radius):
    """Return the mean distance of object `m` at bearing `beta` that its returns imply, and their squared misfit."""
    number, total, squares = 0, 0.0, 0.0
    for k in range(len(ranges)):
        if label[k] == m:
            off = bearings[k] - beta
            across = distance * math.sin(off)
            behind = math.sqrt(max(radius * radius - across * across, 0.0))
            each = (ranges[k] + behind) / max(math.cos(off), 0.1)
            number += 1
            step = each - total
            total += step / number
            squares += step * (each - total)
    return total, squares


@kernel
def posterior_of_centres(ranges, bearings, label, count, spacing, radius, sigma, least, nodes, weights, polar, P):
    """Write distance and bearing (count, 2) into `polar` and their covariances (count, 2, 2) into `P`.

    See `round_centres`; this goes object by object. `label` (k,) belongs to `ranges` and `bearings` (k,).
    """
    means, betas = np.empty(len(nodes)), np.empty(len(nodes))
    misfits = np.empty(len(nodes))
    for m in range(count):
        number, total, first, last = 0, 0.0, math.inf, -math.inf
        for k in range(len(ranges)):
            if label[k] == m:
                number += 1
                total += ranges[k]
                first, last = min(first, bearings[k]), max(last, bearings[k])
        middle, half = 0.5 * (first + last), 0.5 * (last - first)
        distance = total / number + 0.25 * math.pi * radius
        free, beta = 0.0, 0.0
        for _ in range(2):
            width = math.asin(min(radius / distance, 1.0))
            free = max(min(width - half, half + spacing - width), least * spacing)
            for j in range(len(nodes)):
                betas[j] = middle + free * nodes[j]
                means[j], misfits[j] = _fit(ranges, bearings, label, m, betas[j], distance, radius)
            lowest, norm = misfits.min(), 0.0
            distance, beta = 0.0, 0.0
            for j in range(len(nodes)):
                misfits[j] = weights[j] * math.exp(-0.5 * (misfits[j] - lowest) / (sigma * sigma))
                norm += misfits[j]
                distance += misfits[j] * means[j]
                beta += misfits[j] * betas[j]
            distance, beta = distance / norm, beta / norm
            misfits /= norm
        polar[m, 0], polar[m, 1] = distance, beta
        P[m] = 0.0
        for j in range(len(nodes)):
            along, across = means[j] - distance, betas[j] - beta
            P[m, 0, 0] += misfits[j] * along * along
            P[m, 0, 1] += misfits[j] * along * across
            P[m, 1, 1] += misfits[j] * across * across
        P[m, 1, 0] = P[m, 0, 1]
        P[m, 0, 0] += sigma * sigma / number
        P[m, 1, 1] += (free / len(nodes)) ** 2 / 3.0
