"""All people as one array; each is a Kalman filter of the point between two legs."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from . import track_kernels as kernels
from .config import TrackerConfig

Array = NDArray[np.float64]

PERSON = np.dtype(
    [
        ("id", np.int64),
        ("x", np.float64, 4),  # state (x, y, vx, vy) in the odometry frame
        ("p", np.float64, 3),  # covariance, see kalman.py
        ("confidence", np.float64),
        ("offset", np.float64, 2),  # from the centre to the first leg; the second is opposite [m]
        ("age_s", np.float64),
        ("unseen_s", np.float64),
        ("camera_s", np.float64),  # time since a camera saw it; inf: never
    ]
)


def new_people(pairs: NDArray[np.void]) -> NDArray[np.void]:
    """Return people (n,), not yet numbered, each from a pair of leg tracks, `pairs` (n, 2)."""
    people = np.zeros(len(pairs), dtype=PERSON)
    people["x"] = pairs["x"].mean(axis=1)
    people["p"] = pairs["p"].mean(axis=1)
    people["confidence"] = pairs["confidence"].mean(axis=1)
    people["age_s"] = pairs["age_s"].min(axis=1)
    people["camera_s"] = np.inf
    people["offset"] = (pairs["x"][:, 0, :2] - pairs["x"][:, 1, :2]) / 2.0
    return people


def predict(people: NDArray[np.void], dt: float, config: TrackerConfig) -> None:
    """Move `people` `dt` seconds ahead; what is believed of their legs' offsets fades."""
    people["camera_s"] += dt
    people["offset"] *= np.exp(-dt / config.pairing.offset_s)
    clocks = people["age_s"], people["unseen_s"]
    kernels.predict(people["x"], people["p"], *clocks, dt, config.motion.process_variance(dt))


@dataclass(frozen=True, eq=False)
class Sightings:
    """What one scan says about each person.

    Attributes:
        seen: (n,) whether anything of the person was seen.
        centre: (n, 2) where its centre was seen [m].
        confidence: (n,) of what was seen; 0 for the unseen (eq. 6).
        one_leg: (n,) whether it was one leg.
    """

    seen: NDArray[np.bool_]
    centre: Array
    confidence: Array
    one_leg: NDArray[np.bool_]


def measure(people: NDArray[np.void], match: NDArray[np.intp], z: Array, d: Array) -> Sightings:
    """Return what detections `z` (m, 2) of confidence `d` (m,) say; `match` (n, 2) is each leg's detection or -1.

    Two legs measure the centre by their middle (their offset is kept in `people`); one leg measures it less its
    believed offset, which fades to zero, so that a leg seen alone for long is the centre.
    """
    count = len(people)
    sightings = Sightings(np.zeros(count, bool), np.zeros((count, 2)), np.zeros(count), np.zeros(count, bool))
    parts = sightings.seen, sightings.one_leg, sightings.centre, sightings.confidence
    kernels.measure_people(people["offset"], match, z, d, *parts)
    return sightings


def correct(people: NDArray[np.void], sightings: Sightings, dt: float, config: TrackerConfig) -> None:
    """Correct `people` (n,) with what was seen of them; the others stay predicted."""
    variance = np.where(sightings.one_leg, config.motion.r + config.motion.one_leg_variance, config.motion.r)
    measured = sightings.seen, sightings.centre, sightings.confidence, variance
    kernels.correct_people(people, *measured, config.motion.confidence_weight(dt))
