"""Re-identification: people whose track has ended get their number back when they are seen again.

Their places are predicted, their velocity fading. Whoever starts within two standard deviations of such a prediction,
but no farther than the configured distance, and was not yet there when the old track was last seen, is that person.
"""

import numpy as np

from ...slam.view_kernel import inner_kernel, kernel
from .assignment import assigned
from .leg_kernels import since_leg
from .numbers import process_variance
from .track_kernels import distance
from .tracks import LEGS, LOST, NEXT_ID, PEOPLE, keep_lost


@kernel
def predict_lost(tracks, dt, c):
    """Move the lost `dt` seconds ahead; drop those unseen for too long."""
    count = tracks.counts[LOST]
    if count == 0:
        return
    lost = tracks.lost[:count]
    x, p, unseen_s = lost["x"], lost["p"], lost["unseen_s"]
    fade, q = np.exp(-dt / c.motion_coast_s), process_variance(c, dt)
    for i in range(count):
        unseen_s[i] += dt
        a, b, v = p[i, 0], p[i, 1], p[i, 2]
        p[i, 0], p[i, 1], p[i, 2] = a + 2.0 * dt * b + dt * dt * v + q, b + dt * v, v + q
        for k in range(2):
            x[i, k + 2] *= fade
            x[i, k] += dt * x[i, k + 2]
    keep_lost(tracks, unseen_s <= c.reidentification_max_age_s)


@inner_kernel
def lose(tracks, alive, c):
    """Let the people who are not `alive` (n,) end, and be lost, but for those who were hardly known."""
    kept, lost = 0, tracks.counts[LOST]
    for i in range(len(alive)):
        if alive[i]:
            tracks.people[kept] = tracks.people[i]
            kept += 1
        elif tracks.people["age_s"][i] >= c.reidentification_known_s:
            tracks.lost[lost] = tracks.people[i]
            lost += 1
    tracks.counts[PEOPLE], tracks.counts[LOST] = kept, lost


@inner_kernel
def _farness(person, x, y, age_s, c):
    """Return how far (x, y) is from the `person` [m]; inf where who has been there for `age_s` cannot be that one."""
    away = distance(x, y, person.x[0], person.x[1])
    gate = min(2.0 * np.sqrt(person.p[0]), c.reidentification_distance)
    if away > gate or age_s > person.unseen_s + c.reidentification_overlap_s:
        return np.inf
    return away


@inner_kernel
def may_be_legs(tracks, rows, c):
    """Return (k,) whether the leg tracks `rows` (k,) stand where somebody who is lost must be by now."""
    x, age_s = tracks.legs["x"], tracks.legs["age_s"]
    may = np.zeros(len(rows), np.bool_)
    for k in range(len(rows)):
        i = rows[k]
        if age_s[i] >= c.reidentification_near_age_s:
            for j in range(tracks.counts[LOST]):
                if _farness(tracks.lost[j], x[i, 0], x[i, 1], age_s[i], c) <= c.reidentification_near:
                    may[k] = True
    return may


@kernel
def number(tracks, fresh, c):
    """Number the `fresh` people (k,): their old number where they are re-identified, else a new one.

    People of whom no leg was seen for some time still have a track, but it may have slid off to something else; they
    can be re-identified too. Then that track ends with the next scan, and is nobody's to be re-identified.
    """
    people, lost = tracks.people[: tracks.counts[PEOPLE]], tracks.lost[: tracks.counts[LOST]]
    since_s = since_leg(tracks.legs[: tracks.counts[LEGS]], len(people))
    unsure = np.flatnonzero(np.minimum(since_s, people["camera_s"]) > c.reidentification_unseen_s)
    x, age_s, numbers = fresh["x"], fresh["age_s"], fresh["id"]
    cost = np.empty((len(fresh), len(lost) + len(unsure)))
    for i in range(len(fresh)):
        for j in range(len(lost)):
            cost[i, j] = _farness(lost[j], x[i, 0], x[i, 1], age_s[i], c)
        for j in range(len(unsure)):
            cost[i, len(lost) + j] = _farness(people[unsure[j]], x[i, 0], x[i, 1], age_s[i], c)
    rows, columns = assigned(cost, np.full(len(fresh), c.reidentification_distance))
    numbers[:] = -1
    left = np.ones(len(lost), np.bool_)
    for k in range(len(rows)):
        j = columns[k]
        if j < len(lost):
            numbers[rows[k]], left[j] = lost[j].id, False
        else:
            numbers[rows[k]] = people[unsure[j - len(lost)]].id
    keep_lost(tracks, left)
    _number_anew(tracks, people, numbers)


@inner_kernel
def _number_anew(tracks, people, numbers):
    """Give new numbers to those of `people` whose number is now among `numbers` (k,), and where there is none (-1)."""
    for i in range(len(people)):
        if (numbers == people[i].id).any():
            people[i].confidence = people[i].age_s = 0.0
            people[i].id = tracks.counts[NEXT_ID]
            tracks.counts[NEXT_ID] += 1
    for k in range(len(numbers)):
        if numbers[k] < 0:
            numbers[k] = tracks.counts[NEXT_ID]
            tracks.counts[NEXT_ID] += 1
