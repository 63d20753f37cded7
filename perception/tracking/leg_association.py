"""Data association: which detection belongs to which leg track (Ye 2021, section II.A)."""

import numpy as np

from ...slam.view_kernel import inner_kernel, kernel
from . import track_kernels
from .assignment import assigned
from .tracks import LEGS, PEOPLE, take


@kernel
def associate(tracks, z, c):
    """Return (n,) the detection of `z` (m, 2) that each leg track matches, or -1; tracks may change their order.

    Detections are assigned to leg tracks within their gates, and tentative tracks to people of whom a leg is missing.
    """
    legs, centres = tracks.legs[: tracks.counts[LEGS]], tracks.people["x"][: tracks.counts[PEOPLE]]
    gates = gates_of(legs, c)
    cost = np.empty((len(legs), len(z)))
    track_kernels.leg_costs(legs, centres, z, c.gating_reach, c.gating_anchor_s, gates, cost)
    match = np.full(len(legs), -1)
    rows, columns = assigned(cost, gates)
    for i in range(len(rows)):
        match[rows[i]] = columns[i]
    return _fill_missing_legs(tracks, match, z, c)


@kernel
def gates_of(legs, c):
    """Return (n,) how far from each of `legs` a detection of it may be [m]: farther, the longer it was not seen."""
    unseen_s = legs["unseen_s"]
    gates = np.empty(len(legs))
    for i in range(len(legs)):
        gates[i] = min(c.gating_gate + c.gating_gate_speed * unseen_s[i], c.gating_gate_max)
    return gates


@inner_kernel
def _fill_missing_legs(tracks, match, z, c):
    """Give people with a missing leg the tentative tracks that could be it; the missing leg's own track ends."""
    owned = 2 * tracks.counts[PEOPLE]
    missing, free = np.flatnonzero(match[:owned] < 0), owned + np.flatnonzero(match[owned:] >= 0)
    if len(missing) == 0 or len(free) == 0:
        return match
    x, bodies, age_s = tracks.legs["x"], tracks.people["x"], tracks.legs["age_s"]
    cost = np.empty((len(missing), len(free)))
    for i in range(len(missing)):
        leg = missing[i]
        other = leg + 1 - 2 * (leg % 2)
        for j in range(len(free)):
            u, v = z[match[free[j]], 0], z[match[free[j]], 1]
            known = age_s[free[j]] > c.pairing_stride_s / 2.0
            apart = track_kernels.length(tracks.apart[other, free[j], 0], tracks.apart[other, free[j], 1])
            cost[i, j] = track_kernels.distance(x[leg, 0], x[leg, 1], u, v)
            if apart > (c.pairing_width if known else c.pairing_distance):
                cost[i, j] = np.inf
            if track_kernels.distance(bodies[leg // 2, 0], bodies[leg // 2, 1], u, v) > c.gating_reach:
                cost[i, j] = np.inf
    rows, columns = assigned(cost, np.full(len(missing), c.gating_reach))
    if len(rows) == 0:
        return match
    order, kept = np.arange(len(match)), np.ones(len(match), np.bool_)
    for k in range(len(rows)):
        order[missing[rows[k]]] = free[columns[k]]
        kept[free[columns[k]]] = False
    order = order[kept]
    take(tracks, order)
    return match[order]
