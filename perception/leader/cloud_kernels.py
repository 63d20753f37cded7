"""Numba kernels of the cloud of places where the leader may be; `cloud_reference.py` says the same in numpy.

`bodies` (n, 4) are places and velocities (x, y, vx, vy) in the odometry frame, `weights` (n,) how much each counts.
A view is `ranges` (N,) along beams at `first` + i `step` in the frame of the laser at `laser` (3,), no return being the
largest range and no measurement 0.
"""

import numpy as np

from ...slam.view_kernel import inner_kernel, kernel

SURFACE_GAP = 0.3
"""Neighbouring ranges closer than this are one surface [m]."""
CROSSED = 0.05
"""What is left of the weight of a body that went through one."""
BODY_RADIUS = 0.12
"""Half the width that must be free where nobody stands, about a leg's [m]."""
DEPTH = 0.25
"""A return this near is of whoever stands there, or of what is there instead [m]."""
REACH = 1.0
"""Legs farther than this are not the body's [m]."""


@inner_kernel
def _beam(x, y, first, step, laser):
    """Return the index of the beam towards (x, y), beyond the ends where there is none, and the distance."""
    dx, dy = x - laser[0], y - laser[1]
    bearing = (np.arctan2(dy, dx) - laser[2] + np.pi) % (2.0 * np.pi) - np.pi
    if not abs(bearing) <= np.pi:
        return -1, 0.0
    return int(np.floor((bearing - first) / step + 0.5)), np.sqrt(dx * dx + dy * dy)


@kernel
def advance(bodies, weights, pushes, dt, calm, top, ranges, first, step, laser):
    """Let `bodies` walk for `dt`: velocities keep the share `calm`, get `pushes` (n, 2), stay below `top` [m/s].

    Whoever went through a surface of the view all but loses its weight.
    """
    last = len(ranges) - 1
    for k in range(len(bodies)):
        i, before = _beam(bodies[k, 0], bodies[k, 1], first, step, laser)
        vx, vy = calm * bodies[k, 2] + pushes[k, 0], calm * bodies[k, 3] + pushes[k, 1]
        slower = min(1.0, top / max(np.sqrt(vx * vx + vy * vy), 1e-9))
        bodies[k, 2] = slower * vx
        bodies[k, 3] = slower * vy
        bodies[k, 0] += dt * bodies[k, 2]
        bodies[k, 1] += dt * bodies[k, 3]
        j, after = _beam(bodies[k, 0], bodies[k, 1], first, step, laser)
        if min(i, j) < 0 or max(i, j) > last or abs(ranges[i] - ranges[j]) > SURFACE_GAP:
            continue
        if (before < ranges[i]) != (after < ranges[j]):
            weights[k] *= CROSSED


@inner_kernel
def _unseen(x, y, hidden, empty, instead, ranges, first, step, laser):
    """Return how likely nothing of a body at (x, y) is seen: out of sight, in free view, before something else."""
    i, distance = _beam(x, y, first, step, laser)
    half = int(np.ceil(BODY_RADIUS / max(distance, SURFACE_GAP) / step))
    if i - half < 0 or i + half >= len(ranges):
        return hidden
    free = True
    for j in range(i - half, i + half + 1):
        if ranges[j] <= distance + DEPTH:
            free = False
            break
    if free:
        return empty
    return instead if ranges[i] > distance - DEPTH else hidden


@kernel
def weigh(bodies, weights, legs, count, sigma, most, unseen, ranges, first, step, laser):
    """Weigh `bodies` by the `legs` (k, 2) near them, which count `count` (k,), in sum at most `most`, and by the view.

    `unseen` (3,): how likely nothing is seen of a body out of sight, in free view, and before something else.
    """
    for n in range(len(bodies)):
        x, y = bodies[n, 0], bodies[n, 1]
        seen = 0.0
        for j in range(len(legs)):
            away = (x - legs[j, 0]) ** 2 + (y - legs[j, 1]) ** 2
            if away < REACH * REACH:
                seen += count[j] * np.exp(-away / (2.0 * sigma * sigma))
        missed = _unseen(x, y, unseen[0], unseen[1], unseen[2], ranges, first, step, laser)
        weights[n] *= missed + min(seen, most)


@kernel
def explained(bodies, weights, legs, sigma, out):
    """Write into `out` (k,) how well the bodies explain each of `legs` (k, 2), at most 1."""
    for j in range(len(legs)):
        out[j] = 0.0
        for n in range(len(bodies)):
            away = (bodies[n, 0] - legs[j, 0]) ** 2 + (bodies[n, 1] - legs[j, 1]) ** 2
            if away < REACH * REACH:
                out[j] += weights[n] * np.exp(-away / (2.0 * sigma * sigma))


@kernel
def mass_near(bodies, weights, places, radius, out):
    """Write into `out` (k,) the weight of the bodies nearer than `radius` to each of `places` (k, 2)."""
    for j in range(len(places)):
        out[j] = 0.0
        for n in range(len(bodies)):
            if (bodies[n, 0] - places[j, 0]) ** 2 + (bodies[n, 1] - places[j, 1]) ** 2 < radius * radius:
                out[j] += weights[n]


@kernel
def claimed(legs, owner, own, places, seen, own_claim, other_claim, sigma, out):
    """Write into `out` (k,) how well others, expected at `places` (m, 2), explain `legs` (k, 2).

    Each of the others counts `seen` (m,), less the longer it has not been seen. Legs that are nobody's (`owner` -1)
    are claimed by none; those of row `own` count `own_claim`, all others `other_claim`.
    """
    for j in range(len(legs)):
        out[j] = 0.0
        if owner[j] < 0:
            continue
        for i in range(len(places)):
            away = (legs[j, 0] - places[i, 0]) ** 2 + (legs[j, 1] - places[i, 1]) ** 2
            out[j] = max(out[j], seen[i] * np.exp(-away / (2.0 * sigma * sigma)))
        out[j] *= own_claim if owner[j] == own else other_claim
