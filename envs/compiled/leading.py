"""Whom the robot takes for its leader where people are known by the truth: `LeaderSelector` in compiled form.

Chosen is who is nearest as the drive begins; the one who is chosen is kept while known, and predicted on when not.
Equal to the selector of the onboard stack (tested).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...perception.config import PerceptionConfig
from ...slam.view_kernel import view_kernel

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

CHOSEN_S, WAITING_S, UNSEEN_S, VISIBLE, CHOSEN = range(5)
"""Columns of the selector's numbers: when the leader was chosen, since when somebody is known [s], for how long the
leader was not seen [s], whether it is seen, whether anybody was chosen yet."""
MEMORY = 5


class Selecting(NamedTuple):
    """Numbers of `LeaderConfig` and `MotionConfig`; kernels take it as it is."""

    onset_s: float
    onset_near: float
    onset_far: float
    patience_s: float
    search_sigmas: float
    search_distance: float
    search_overlap_s: float
    duplicate_distance: float
    variance: float
    noise: float
    coast_s: float


def selecting(perception: PerceptionConfig, dt: float) -> Selecting:
    """Return the numbers for scans that are `dt` [s] apart."""
    leader, motion = perception.leader, perception.tracker.motion
    return Selecting(
        leader.onset_s, leader.onset_near, leader.onset_far, leader.patience_s, leader.search_sigmas,
        leader.search_distance, leader.search_overlap_s, leader.duplicate_distance, motion.initial_variance,
        motion.process_variance(dt), motion.coast_s,
    )  # fmt: skip


@view_kernel
def select(
    time_s: float,
    dt: float,
    known: Flags,
    apart: Array,
    places: Array,
    motions: Array,
    rules: Selecting,
    track: int,
    memory: Array,
    estimate: Array,
    covariance: Array,
    duplicate: Flags,
) -> int:
    """Return the row of the person who is the leader now, -1 for nobody; what the robot remembers is updated.

    Args:
        time_s: Of the scan [s].
        dt: Since the last one [s].
        known: (n,) which people the robot knows.
        apart: (n,) their distances from it [m].
        places: (n, 2) where they are, odometry frame [m].
        motions: (n, 2) how they move in it [m/s].
        rules: How the leader is chosen and looked for.
        track: The row before.
        memory: (MEMORY,).
        estimate: (4,) leader's place [m] and velocity [m/s] in the odometry frame.
        covariance: (3,) variance of the place, covariance, variance of the velocity while it is looked for.
        duplicate: (n,) who was ever nearer to the leader than two bodies can be.
    """
    found = _chosen(time_s, known, apart, rules, memory)
    if found < 0:
        if memory[CHOSEN] == 0.0:
            return -1
        if track >= 0 and known[track]:
            _note_duplicates(track, known, places, rules.duplicate_distance, duplicate)
            found = track
        else:
            found = _looked_for(time_s, dt, known, places, rules, memory, estimate, covariance, duplicate)
    if found < 0:
        memory[VISIBLE] = 0.0
        memory[UNSEEN_S] += dt
        return -1
    memory[VISIBLE], memory[UNSEEN_S], memory[CHOSEN] = 1.0, 0.0, 1.0
    estimate[0], estimate[1] = places[found, 0], places[found, 1]
    estimate[2], estimate[3] = motions[found, 0], motions[found, 1]
    covariance[0], covariance[1], covariance[2] = rules.variance, 0.0, rules.variance
    return found


@view_kernel
def _chosen(time_s: float, known: Flags, apart: Array, rules: Selecting, memory: Array) -> int:
    """Return who is chosen in this scan; -1: nobody, or the time to choose is over."""
    before = memory[CHOSEN] > 0.0
    if before and time_s - memory[CHOSEN_S] >= rules.onset_s:
        return -1
    nearest = -1
    for i in range(len(known)):
        if known[i] and (nearest < 0 or apart[i] < apart[nearest]):
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


@view_kernel
def _note_duplicates(track: int, known: Flags, places: Array, distance: float, duplicate: Flags) -> None:
    for i in range(len(known)):
        if known[i] and i != track:
            away = np.hypot(places[i, 0] - places[track, 0], places[i, 1] - places[track, 1])
            duplicate[i] = duplicate[i] or away < distance


@view_kernel
def _looked_for(
    time_s: float,
    dt: float,
    known: Flags,
    places: Array,
    rules: Selecting,
    memory: Array,
    estimate: Array,
    covariance: Array,
    duplicate: Flags,
) -> int:
    """Predict the leader; return who appears where it must be, -1 for nobody."""
    fade = np.exp(-dt / rules.coast_s)
    estimate[2] *= fade
    estimate[3] *= fade
    estimate[0] += dt * estimate[2]
    estimate[1] += dt * estimate[3]
    a, b, c = covariance[0], covariance[1], covariance[2]
    covariance[0] = a + 2.0 * dt * b + dt * dt * c + rules.noise
    covariance[1], covariance[2] = b + dt * c, c + rules.noise
    gate = min(rules.search_distance, rules.search_sigmas * np.sqrt(covariance[0]))
    late = time_s > memory[UNSEEN_S] + dt + rules.search_overlap_s
    nearest, least = -1, gate
    for i in range(len(known)):
        if known[i] and (duplicate[i] or not late):
            away = np.hypot(places[i, 0] - estimate[0], places[i, 1] - estimate[1])
            if away < least:
                nearest, least = i, away
    return nearest
