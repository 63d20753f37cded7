"""Legs that are not the leader's, whoever's track takes them later.

Somebody who stands is no person for the tracker before moving, and in passing the leader's track can slide over to such
legs. But they were seen apart from the leader before: from scan to scan each leg inherits that from the leg nearest to
where it is.
"""

import numpy as np

from ...slam.view_kernel import inner_kernel, kernel
from ..tracking.geometry_kernels import distance

STEP_M = 0.25
"""No leg moves farther than this from one scan to the next [m]."""
SCANS = 3
"""In so many scans in a row a leg must be seen apart from the leader to count as somebody else's."""
UNSEEN_S = 0.5
"""A leg of somebody else is recognised for this long after it was seen [s]."""
EXPLAINED = 0.1
"""A leg that the leader's body explains so well may be the leader's."""
UNEXPLAINED_S = 0.4
"""If the leader's own track has had nothing but legs of others for so long, those are the leader's after all [s]."""
FOLLOWED = np.dtype(
    [
        ("place", np.float64, 2),  # odometry frame [m]
        ("unseen_s", np.float64),
        ("apart", np.int64),  # scans in a row apart from the leader; somebody else's from `SCANS` on
    ]
)


@kernel
def follow_legs(memory, legs, dt):
    """Take the `legs` (k, 2) of a scan, `dt` [s] after the last one, in the odometry frame."""
    one = memory.leader[0]
    old = memory.followed[: one.followed].copy()
    for j in range(len(legs)):
        nearest, least, row = 0, np.inf, memory.followed[j]
        for i in range(len(old)):
            away = distance(legs[j, 0], legs[j, 1], old[i].place[0], old[i].place[1])
            if away < least:
                nearest, least = old[i].apart, away
        row.place[0], row.place[1] = legs[j, 0], legs[j, 1]
        row.unseen_s, row.apart = 0.0, nearest if least < STEP_M else 0
    count = len(legs)
    for i in range(len(old)):
        if old[i].apart >= SCANS and old[i].unseen_s + dt < UNSEEN_S and _is_gone(old[i], legs):
            memory.followed[count] = old[i]
            memory.followed[count].unseen_s += dt
            count += 1
    one.followed, one.now = count, len(legs)


@inner_kernel
def _is_gone(followed, legs):
    """Return whether none of `legs` (k, 2) can be the one that is `followed`."""
    for j in range(len(legs)):
        if distance(legs[j, 0], legs[j, 1], followed.place[0], followed.place[1]) < STEP_M:
            return False
    return True


@kernel
def others_among(memory, own, explained, dt):
    """Return (k,) which of the last legs are somebody else's.

    Args:
        memory: Of the selector.
        own: (k,) which are of the track that carries the leader.
        explained: (k,) how well the leader's body explains each, in [0, 1].
        dt: Since this was last asked [s].
    """
    one, apart = memory.leader[0], memory.followed["apart"]
    others = apart[: one.now] >= SCANS
    unexplained = (others & own).any() and not (~others & (explained > EXPLAINED)).any()
    one.unexplained_s = one.unexplained_s + dt if unexplained else 0.0
    if one.unexplained_s > UNEXPLAINED_S:
        for j in range(len(own)):
            if own[j]:
                apart[j], others[j] = 0, False
    return others


@kernel
def observe_apart(memory, apart):
    """Take which of the last legs, (k,), are nobody's and apart from a leader in view."""
    scans = memory.followed["apart"]
    for j in range(len(apart)):
        if scans[j] < SCANS:
            scans[j] = scans[j] + 1 if apart[j] else 0
