"""What the kernels of `cloud_kernels.py` do, in plain numpy; the tests compare them."""

import numpy as np
from numpy.typing import NDArray
from tagalong.perception.leader.cloud_kernels import BODY_RADIUS, CROSSED, DEPTH, REACH, SURFACE_GAP

Array = NDArray[np.float64]


def beams(places: Array, first: float, step: float, laser: Array) -> tuple[NDArray[np.intp], Array]:
    """Return (n,) indices of the beams towards `places` (n, 2), beyond the ends where there is none, and distances."""
    offset = places - laser[:2]
    bearing = (np.arctan2(offset[:, 1], offset[:, 0]) - laser[2] + np.pi) % (2.0 * np.pi) - np.pi
    return np.floor((bearing - first) / step + 0.5).astype(np.intp), np.hypot(offset[:, 0], offset[:, 1])


def advance(
    bodies: Array, weights: Array, pushes: Array, dt: float, calm: float, top: float,
    ranges: Array, first: float, step: float, laser: Array,
) -> None:  # fmt: skip
    """Let `bodies` walk; whoever went through a surface of the view all but loses its weight."""
    i, before = beams(bodies[:, :2], first, step, laser)
    velocity = calm * bodies[:, 2:] + pushes
    speed = np.maximum(np.hypot(velocity[:, 0], velocity[:, 1]), 1e-9)
    bodies[:, 2:] = velocity * np.minimum(1.0, top / speed)[:, None]
    bodies[:, :2] += dt * bodies[:, 2:]
    j, after = beams(bodies[:, :2], first, step, laser)
    known = (np.minimum(i, j) >= 0) & (np.maximum(i, j) < len(ranges))
    here, there = (ranges[np.clip(index, 0, len(ranges) - 1)] for index in (i, j))
    crossed = known & (np.abs(here - there) <= SURFACE_GAP) & ((before < here) != (after < there))
    weights[crossed] *= CROSSED


def weigh(
    bodies: Array, weights: Array, legs: Array, count: Array, sigma: float, most: float, unseen: Array,
    ranges: Array, first: float, step: float, laser: Array,
) -> None:  # fmt: skip
    """Weigh `bodies` by the `legs` near them and by the view."""
    seen = np.minimum((_nearness(bodies, legs, sigma) * count).sum(axis=1), most)
    hidden, empty, instead = unseen
    for n, (i, distance) in enumerate(zip(*beams(bodies[:, :2], first, step, laser), strict=True)):
        half = int(np.ceil(BODY_RADIUS / max(distance, SURFACE_GAP) / step))
        missed = hidden
        if i - half >= 0 and i + half < len(ranges):
            if (ranges[i - half : i + half + 1] > distance + DEPTH).all():
                missed = empty
            elif ranges[i] > distance - DEPTH:
                missed = instead
        weights[n] *= missed + seen[n]


def explained(bodies: Array, weights: Array, legs: Array, sigma: float) -> Array:
    """Return (k,) how well the bodies explain each of `legs` (k, 2)."""
    return weights @ _nearness(bodies, legs, sigma)


def mass_near(bodies: Array, weights: Array, places: Array, radius: float) -> Array:
    """Return (k,) the weight of the bodies nearer than `radius` to each of `places` (k, 2)."""
    return weights @ (_apart(bodies[:, :2], places) < radius)


def claimed(
    legs: Array, owner: NDArray[np.intp], own: int, places: Array, seen: Array,
    own_claim: float, other_claim: float, sigma: float,
) -> Array:  # fmt: skip
    """Return (k,) how well others, expected at `places` (m, 2) and `seen` (m,) of late, explain `legs` (k, 2)."""
    best = (seen * np.exp(-(_apart(legs, places) ** 2) / (2.0 * sigma**2))).max(axis=1, initial=0.0)
    return np.where(owner < 0, 0.0, np.where(owner == own, own_claim, other_claim) * best)


def _apart(a: Array, b: Array) -> Array:
    return np.hypot(*(a[:, None] - b[None]).transpose(2, 0, 1))


def _nearness(bodies: Array, legs: Array, sigma: float) -> Array:
    apart = _apart(bodies[:, :2], legs)
    return np.where(apart < REACH, np.exp(-(apart**2) / (2.0 * sigma**2)), 0.0)
