"""Whom the robot takes for its leader where tracks keep their numbers: `LeaderSelector` in compiled form.

Chosen is who is nearest as the drive begins; the one who is chosen is kept while known, and predicted on when not.
Equal to the selector of the onboard stack (tested).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...perception.config import PerceptionConfig
from ...slam.view_kernel import inner_view_kernel, view_kernel

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

CHOSEN_S, WAITING_S, UNSEEN_S, VISIBLE, CHOSEN, TRUST, FIRST = range(7)
"""Columns of the selector's numbers: when the leader was chosen, since when somebody is known [s], for how long the
leader was not seen [s], whether it is seen, whether anybody was chosen yet, confidence of its track, row of who was
chosen."""
MEMORY = 7


class Known(NamedTuple):
    """What the robot knows of n people; kernels take it as it is.

    Attributes:
        who: (n,) whether the robot knows each.
        apart: (n,) their distances from it [m].
        places: (n, 2) where they are, odometry frame [m].
        motions: (n, 2) how they move in it [m/s].
        unseen_s: (n,) for how long they have not been seen [s].
        trust: (n,) confidence of their tracks.
    """

    who: Flags
    apart: Array
    places: Array
    motions: Array
    unseen_s: Array
    trust: Array


class Selecting(NamedTuple):
    """Numbers of `LeaderConfig` and `MotionConfig`; kernels take it as it is."""

    onset_s: float
    onset_near: float
    onset_far: float
    patience_s: float
    search_sigmas: float
    search_distance: float
    search_overlap_s: float
    variance: float
    noise: float
    coast_s: float


def selecting(perception: PerceptionConfig, dt: float) -> Selecting:
    """Return the numbers for scans that are `dt` [s] apart."""
    leader, motion = perception.leader, perception.tracker.motion
    return Selecting(
        leader.onset_s, leader.onset_near, leader.onset_far, leader.patience_s, leader.search_sigmas,
        leader.search_distance, leader.search_overlap_s, motion.initial_variance, motion.process_variance(dt),
        motion.coast_s,
    )  # fmt: skip


@view_kernel
def select(
    time_s: float,
    dt: float,
    known: Known,
    rules: Selecting,
    track: int,
    memory: Array,
    estimate: Array,
    covariance: Array,
) -> int:
    """Return the row of the person who is the leader now, -1 for nobody; what the robot remembers is updated.

    Args:
        time_s: Of the scan [s].
        dt: Since the last one [s].
        known: The people.
        rules: How the leader is chosen and looked for.
        track: The row before.
        memory: (MEMORY,).
        estimate: (4,) leader's place [m] and velocity [m/s] in the odometry frame.
        covariance: (3,) variance of the place, covariance, variance of the velocity while it is looked for.
    """
    found = _chosen(time_s, known, rules, memory)
    if found >= 0:
        memory[FIRST] = found
    elif memory[CHOSEN] == 0.0:
        return -1
    elif known.who[int(memory[FIRST])]:
        found = int(memory[FIRST])
    elif track >= 0 and known.who[track]:
        found = track
    else:
        found = _looked_for(time_s, dt, known, rules, memory, estimate, covariance)
    if found < 0:
        memory[VISIBLE] = memory[TRUST] = 0.0
        memory[UNSEEN_S] += dt
        return -1
    memory[VISIBLE] = 1.0 if known.unseen_s[found] == 0.0 else 0.0
    memory[UNSEEN_S], memory[TRUST], memory[CHOSEN] = known.unseen_s[found], known.trust[found], 1.0
    estimate[0], estimate[1] = known.places[found, 0], known.places[found, 1]
    estimate[2], estimate[3] = known.motions[found, 0], known.motions[found, 1]
    covariance[0], covariance[1], covariance[2] = rules.variance, 0.0, rules.variance
    return found


@inner_view_kernel
def _chosen(time_s: float, known: Known, rules: Selecting, memory: Array) -> int:
    """Return who is chosen in this scan; -1: nobody, or the time to choose is over."""
    before = memory[CHOSEN] > 0.0
    if before and time_s - memory[CHOSEN_S] >= rules.onset_s:
        return -1
    nearest, apart = -1, known.apart
    for i in range(len(apart)):
        if known.who[i] and (nearest < 0 or apart[i] < apart[nearest]):
            nearest = i
    if nearest < 0:
        return -1
    memory[WAITING_S] = min(memory[WAITING_S], time_s)
    patient = not before and time_s - memory[WAITING_S] < rules.patience_s
    if apart[nearest] > (rules.onset_near if patient else rules.onset_far):
        return -1
    if not before:
        memory[CHOSEN_S] = time_s
    return nearest


@inner_view_kernel
def _looked_for(
    time_s: float,
    dt: float,
    known: Known,
    rules: Selecting,
    memory: Array,
    estimate: Array,
    covariance: Array,
) -> int:
    """Predict the leader; return who appears where it must be, -1 for nobody."""
    fade = math.exp(-dt / rules.coast_s)
    estimate[2] *= fade
    estimate[3] *= fade
    estimate[0] += dt * estimate[2]
    estimate[1] += dt * estimate[3]
    a, b, c = covariance[0], covariance[1], covariance[2]
    covariance[0] = a + 2.0 * dt * b + dt * dt * c + rules.noise
    covariance[1], covariance[2] = b + dt * c, c + rules.noise
    gate = min(rules.search_distance, rules.search_sigmas * math.sqrt(covariance[0]))
    late = time_s > memory[UNSEEN_S] + dt + rules.search_overlap_s
    nearest, least = -1, gate
    places = known.places
    for i in range(len(places)):
        if known.who[i] and not late:
            away = math.hypot(places[i, 0] - estimate[0], places[i, 1] - estimate[1])
            if away < least:
                nearest, least = i, away
    return nearest
