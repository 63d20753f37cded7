"""Legs that were assigned to the wrong people, put right."""

import numpy as np

from ...slam.view_kernel import inner_kernel, kernel
from .pairing import better_pairs
from .track_kernels import any_wide, length
from .tracks import LEGS, PEOPLE, count_owned, take


@inner_kernel
def exchange(tracks, match, c):
    """Exchange legs between people, and with tentative tracks, where that makes pairs narrower over a stride.

    Returns `match` (n,), the detection of each leg track or -1, in the tracks' new order.
    """
    people, count, margin = tracks.counts[PEOPLE], tracks.counts[LEGS], c.pairing_margin
    if people == 0:
        return match
    before = np.arange(2 * people).reshape((people, 2))
    if not any_wide(tracks.apart, before, margin):
        return match
    legs = tracks.legs
    known = (legs["age_s"][2 * people : count] > c.pairing_stride_s / 2.0) & (
        legs["unseen_s"][2 * people : count] == 0.0
    )
    free = 2 * people + np.flatnonzero(known)
    pairs = better_pairs(spread_of(tracks), before, legs["owned_s"][:count], free, margin)
    if (pairs == before).all():
        return match
    x, bodies = legs["x"], tracks.people["x"]
    loose = np.ones(count, np.bool_)
    for i in range(people):
        a, b = pairs[i, 0], pairs[i, 1]
        loose[a] = loose[b] = False
        if a != before[i, 0] or b != before[i, 1]:
            for k in range(2):
                bodies[i, k] = (x[a, k] + x[b, k]) / 2.0
    order = np.concatenate((pairs.ravel(), np.flatnonzero(loose)))
    take(tracks, order)
    count_owned(tracks, 0.0)
    return match[order]


@kernel
def spread_of(tracks):
    """Return (n, n) lengths of `apart` [m]."""
    count = tracks.counts[LEGS]
    spread = np.empty((count, count))
    for i in range(count):
        for j in range(count):
            spread[i, j] = length(tracks.apart[i, j, 0], tracks.apart[i, j, 1])
    return spread
