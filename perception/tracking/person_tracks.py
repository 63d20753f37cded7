"""People: each is a Kalman filter of the point between two legs."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...slam.view_kernel import inner_kernel, kernel
from . import track_kernels as kernels
from .numbers import confidence_weight, process_variance
from .reidentification import number
from .tracks import LEGS, PEOPLE, take


class Sightings(NamedTuple):
    """What one scan says about each of n people.

    Attributes:
        seen: (n,) whether anything of the person was seen.
        one_leg: (n,) whether it was one leg.
        centre: (n, 2) where its centre was seen [m].
        confidence: (n,) of what was seen; 0 for the unseen (eq. 6).
    """

    seen: NDArray[np.bool_]
    one_leg: NDArray[np.bool_]
    centre: NDArray[np.float64]
    confidence: NDArray[np.float64]


@kernel
def predict_people(people, dt, c):
    """Move `people` (n,) `dt` seconds ahead; what is believed of their legs' offsets fades."""
    camera_s, offset, fade = people["camera_s"], people["offset"], np.exp(-dt / c.pairing_offset_s)
    for i in range(len(people)):
        camera_s[i] += dt
        offset[i, 0] *= fade
        offset[i, 1] *= fade
    kernels.predict(people["x"], people["p"], people["age_s"], people["unseen_s"], dt, process_variance(c, dt))


@kernel
def measure(people, match, z, d):
    """Return what detections `z` (m, 2) of confidence `d` (m,) say; `match` (2 n,) is each leg's detection or -1.

    Two legs measure the centre by their middle (their offset is kept in `people`); one leg measures it less its
    believed offset, which fades to zero, so that a leg seen alone for long is the centre.
    """
    n = len(people)
    sightings = Sightings(np.zeros(n, np.bool_), np.zeros(n, np.bool_), np.zeros((n, 2)), np.zeros(n))
    kernels.measure_people(
        people["offset"], match.copy().reshape((n, 2)), z, d, sightings.seen, sightings.one_leg, sightings.centre,
        sightings.confidence,
    )  # fmt: skip
    return sightings


@kernel
def correct_people(people, sightings, dt, c):
    """Correct `people` (n,) with what was seen of them; the others stay predicted."""
    variance = np.full(len(people), c.motion_r)
    variance[sightings.one_leg] = c.motion_r + c.motion_one_leg_variance
    seen, centre, confidence = sightings.seen, sightings.centre, sightings.confidence
    kernels.correct_people(people, seen, centre, confidence, variance, confidence_weight(c, dt))


@kernel
def confirm(tracks, pairs, c):
    """Make people of the pairs of tentative tracks `pairs` (k, 2), under their old number where they have one."""
    if len(pairs) == 0:
        return
    before, count = tracks.counts[PEOPLE], tracks.counts[LEGS]
    fresh = tracks.people[before : before + len(pairs)]
    loose = np.ones(count, np.bool_)
    loose[: 2 * before] = False
    for k in range(len(pairs)):
        _begin(fresh, k, tracks.legs, pairs[k, 0], pairs[k, 1])
        loose[pairs[k, 0]] = loose[pairs[k, 1]] = False
    number(tracks, fresh, c)
    tracks.counts[PEOPLE] = before + len(pairs)
    take(tracks, np.concatenate((np.arange(2 * before), pairs.copy().ravel(), np.flatnonzero(loose))))


@inner_kernel
def _begin(people, i, legs, a, b):
    """Make person i, not yet numbered, of the leg tracks a and b."""
    for k in range(4):
        people["x"][i, k] = (legs["x"][a, k] + legs["x"][b, k]) / 2.0
    for k in range(3):
        people["p"][i, k] = (legs["p"][a, k] + legs["p"][b, k]) / 2.0
    for k in range(2):
        people["offset"][i, k] = (legs["x"][a, k] - legs["x"][b, k]) / 2.0
    people["confidence"][i] = (legs["confidence"][a] + legs["confidence"][b]) / 2.0
    people["age_s"][i] = min(legs["age_s"][a], legs["age_s"][b])
    people["unseen_s"][i], people["camera_s"][i] = 0.0, np.inf
