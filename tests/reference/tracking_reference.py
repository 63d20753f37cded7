"""What the kernels of `track_kernels.py` do, in plain numpy; the tests compare them."""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import cdist
from tagalong.perception.tracking import kalman

Array = NDArray[np.float64]


def predict(tracks: NDArray[np.void], dt: float, q: float) -> None:
    """Move `tracks` (n,) of `LEG` or `PERSON` `dt` seconds ahead."""
    tracks["x"], tracks["p"] = kalman.predict(tracks["x"], tracks["p"], dt, q)
    tracks["age_s"] += dt
    tracks["unseen_s"] += dt


def correct_legs(legs: NDArray[np.void], match: NDArray[np.intp], z: Array, d: Array, r: float, gain: float) -> None:
    """Correct leg tracks (n,) with detections `z` (m, 2) of confidence `d` (m,); `match` (n,) is a detection or -1."""
    seen = np.flatnonzero(match >= 0)
    found = match[seen]
    legs["x"][seen], legs["p"][seen] = kalman.update(legs["x"][seen], legs["p"][seen], z[found], r)
    legs["confidence"] *= 1.0 - gain
    legs["confidence"][seen] += gain * d[found]
    legs["unseen_s"][seen] = 0.0
    legs["seen"][seen] = z[found]
    legs["low"][seen] = np.minimum(legs["low"][seen], z[found])
    legs["high"][seen] = np.maximum(legs["high"][seen], z[found])


def correct_people(
    people: NDArray[np.void],
    seen: NDArray[np.bool_],
    centre: Array,
    confidence: Array,
    variance: Array,
    gain: float,
) -> None:
    """Correct `people` (n,) where `seen` (n,), at `centre` (n, 2) with `variance` (n,)."""
    people["x"][seen], people["p"][seen] = kalman.update(
        people["x"][seen], people["p"][seen], centre[seen], variance[seen]
    )
    people["confidence"] += gain * (confidence - people["confidence"])
    people["unseen_s"][seen] = 0.0


def measure_people(
    offset: Array, match: NDArray[np.intp], z: Array, d: Array
) -> tuple[NDArray[np.bool_], NDArray[np.bool_], Array, Array]:
    """Return (seen, one_leg, centre, confidence) that `measure_people` of the kernels writes; keep `offset`."""
    seen = match >= 0
    both, one = seen.all(axis=1), seen[:, 0] ^ seen[:, 1]
    first, second = match[both].T
    offset[both] = (z[first] - z[second]) / 2.0
    centre, confidence = np.zeros((len(match), 2)), np.zeros(len(match))
    centre[both] = (z[first] + z[second]) / 2.0
    confidence[both] = (d[first] + d[second]) / 2.0
    alone = match[one].max(axis=1)
    side = np.where(seen[one, 0], 1.0, -1.0)
    centre[one] = z[alone] - side[:, None] * offset[one]
    confidence[one] = d[alone]
    return both | one, one, centre, confidence


def leg_costs(legs: NDArray[np.void], centres: Array, z: Array, reach: float, anchor_s: float, gates: Array) -> Array:
    """Return (n, m) how far detections `z` (m, 2) are from the leg tracks; inf beyond `gates` (n,)."""
    cost = np.asarray(cdist(legs["x"][:, :2], z), dtype=np.float64)
    fresh = legs["unseen_s"] <= anchor_s
    cost[fresh] = np.minimum(cost[fresh], cdist(legs["seen"][fresh], z))
    cost[cost >= gates[:, None]] = np.inf
    cost[: 2 * len(centres)][np.repeat(cdist(centres, z), 2, axis=0) > reach] = np.inf
    return cost


def average_apart(positions: Array, age_s: Array, apart: Array, dt: float, stride_s: float) -> Array:
    """Return (n, n, 2) the running means `apart` after the present vectors between `positions` (n, 2)."""
    together_s = np.minimum(age_s[:, None], age_s)
    weight = np.maximum(dt / stride_s, dt / np.maximum(together_s, dt))
    now = positions[:, None] - positions
    return np.asarray(apart + np.minimum(weight, 1.0)[..., None] * (now - apart), dtype=np.float64)


def with_fresh(apart: Array, positions: Array) -> Array:
    """Return (n, n, 2) the means `apart` (k, k, 2), and the present vectors to those of `positions` beyond the k-th."""
    grown = positions[:, None] - positions
    grown[: len(apart), : len(apart)] = apart
    return np.asarray(grown, dtype=np.float64)


def points_of_things(
    points: Array,
    start: NDArray[np.int64],
    end: NDArray[np.int64],
    thing: NDArray[np.bool_],
    humans: Array,
    zeta: float,
) -> Array:
    """Return (j, 2) those of `points` (k, 2) in the clusters `thing` (m,), farther than `zeta` from `humans` (h, 2)."""
    edges = np.zeros(len(points) + 1, dtype=np.int64)
    np.add.at(edges, start[thing], 1)
    np.subtract.at(edges, end[thing], 1)
    chosen = points[np.cumsum(edges[:-1]) > 0]
    return chosen[cdist(humans, chosen).min(axis=0, initial=np.inf) > zeta] if len(humans) else chosen
