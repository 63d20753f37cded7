"""Numba kernels that ask all leg tracks one question; `tests/reference/leg_tracks_reference.py` says the same in numpy.

`legs` (n,) are of `LEG`, `people` (k,) of `PERSON`; the first 2 k legs are theirs. `match` (n,) is the detection of
each track in this scan, or -1.
"""

import numpy as np

from ...slam.view_kernel import kernel, spliced_kernel


@spliced_kernel
def _length(x, y):
    return np.sqrt(x**2 + y**2)


@kernel
def moved(legs):
    """Return (n,) how large the area is that each of `legs` has been in: the diagonal of the box around it [m]."""
    low, high = legs["low"], legs["high"]
    size = np.empty(len(legs))
    for i in range(len(legs)):
        size[i] = _length(high[i, 0] - low[i, 0], high[i, 1] - low[i, 1])
    return size


@kernel
def promising(legs, first, c_min, unseen_s):
    """Return (k,) the rows from `first` on that are believed in (more than `c_min`) and were seen within `unseen_s`."""
    confidence, unseen = legs["confidence"], legs["unseen_s"]
    rows = np.empty(len(legs), np.int64)
    count = 0
    for i in range(first, len(legs)):
        if confidence[i] > c_min and unseen[i] <= unseen_s:
            rows[count] = i
            count += 1
    return rows[:count]


@kernel
def still(legs, first, match, age_s, least, count):
    """Return (`count`,) which detections are of tracks, from `first` on, of `age_s` that moved less than `least`."""
    low, high, age = legs["low"], legs["high"], legs["age_s"]
    found = np.zeros(count, np.bool_)
    for i in range(first, len(legs)):
        small = _length(high[i, 0] - low[i, 0], high[i, 1] - low[i, 1]) < least
        if small and match[i] >= 0 and age[i] > age_s:
            found[match[i]] = True
    return found


@kernel
def carry_hidden(legs, people, match):
    """Move the unseen legs of `people` along with them, each to where its offset is believed to be."""
    x, bodies, offset = legs["x"], people["x"], people["offset"]
    for i in range(2 * len(people)):
        if match[i] >= 0:
            continue
        side = 1.0 if i % 2 == 0 else -1.0
        for k in range(2):
            x[i, k] = bodies[i // 2, k] + side * offset[i // 2, k]
            x[i, k + 2] = bodies[i // 2, k + 2]


@kernel
def human_places(people, legs, least, lost):
    """Return (h, 2) where people, their legs, lone tracks that moved `least` [m], and the `lost` (l, 2) are."""
    bodies, x, low, high = people["x"], legs["x"], legs["low"], legs["high"]
    places = np.empty((len(people) + len(legs) + len(lost), 2))
    count = len(people)
    for i in range(count):
        places[i, 0], places[i, 1] = bodies[i, 0], bodies[i, 1]
    for i in range(len(legs)):
        if i < 2 * len(people) or _length(high[i, 0] - low[i, 0], high[i, 1] - low[i, 1]) >= least:
            places[count, 0], places[count, 1] = x[i, 0], x[i, 1]
            count += 1
    for i in range(len(lost)):
        places[count, 0], places[count, 1] = lost[i, 0], lost[i, 1]
        count += 1
    return places[:count]


@kernel
def unmatched(match, count):
    """Return (k,) which of `count` detections belong to no track."""
    taken = np.zeros(count, np.bool_)
    for j in match:
        if j >= 0:
            taken[j] = True
    return np.flatnonzero(~taken)


@kernel
def seen_now(legs, people):
    """Return the rows (k,) of tracks seen in the last scan, and the person (k,) that each belongs to; -1 for nobody."""
    unseen = legs["unseen_s"]
    rows, owner = np.empty(len(legs), np.int64), np.empty(len(legs), np.int64)
    count = 0
    for i in range(len(legs)):
        if unseen[i] == 0.0:
            rows[count] = i
            owner[count] = i // 2 if i < 2 * people else -1
            count += 1
    return rows[:count], owner[:count]


@kernel
def since_leg(legs, people):
    """Return (`people`,) the time since a leg of each person was seen apart [s]."""
    unseen = legs["unseen_s"]
    least = np.empty(people)
    for i in range(people):
        least[i] = min(unseen[2 * i], unseen[2 * i + 1])
    return least


@kernel
def restart_moving(legs, i):
    """Let track i of `legs` begin here, as if it had not moved yet."""
    x = legs["x"]
    for k in range(2):
        legs["first"][i, k] = legs["low"][i, k] = legs["high"][i, k] = x[i, k]
