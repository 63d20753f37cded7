"""Re-identification: people whose hypothesis has ended get their number back when they are seen again."""

import numpy as np

from ...slam.view_kernel import inner_kernel
from .tracks import LOST


@inner_kernel
def lose(tracks, rows, kept, time_s, c):
    """Remember the people among the hypotheses `rows` (n,) that are not `kept` (n,); forget those lost for too long."""
    lost, count = tracks.lost, tracks.counts[LOST]
    for i in range(len(rows)):
        if not kept[i] and rows[i].id >= 0 and rows[i].age_s >= c.reidentification_known_s:
            lost[count].id, lost[count].seen_s = rows[i].id, time_s - rows[i].unseen_s
            for k in range(4):
                lost[count].x[k] = rows[i].x[k]
            count += 1
    tracks.counts[LOST] = 0
    for i in range(count):
        if time_s - lost[i].seen_s <= c.reidentification_max_age_s:
            lost[tracks.counts[LOST]] = lost[i]
            tracks.counts[LOST] += 1


@inner_kernel
def nearest_lost(tracks, somebody, time_s, c):
    """Return the row of the lost person who may be `somebody` and is nearest; -1: there is none.

    It is within a step and what somebody walks in the time since, and was not there long before the other was lost.
    """
    row, least = -1, np.inf
    for i in range(tracks.counts[LOST]):
        one = tracks.lost[i]
        gone_s = time_s - one.seen_s
        drift = c.motion_coast_s * (1.0 - np.exp(-gone_s / c.motion_coast_s))
        dx, dy = one.x[0] + drift * one.x[2] - somebody.x[0], one.x[1] + drift * one.x[3] - somebody.x[1]
        apart = np.hypot(dx, dy)
        gate = min(c.reidentification_distance, c.reidentification_step + gone_s)
        if apart <= gate and apart < least and somebody.age_s <= gone_s + c.reidentification_overlap_s:
            row, least = i, apart
    return row


@inner_kernel
def taken(tracks, row):
    """Return the number of the lost person in this `row`, who is found again."""
    number = tracks.lost[row].id
    for i in range(row, tracks.counts[LOST] - 1):
        tracks.lost[i] = tracks.lost[i + 1]
    tracks.counts[LOST] -= 1
    return number
