"""A scan's way through the stages of multi-target tracking, as one kernel.

Prediction, data association, correction, track termination, track confirmation with re-identification; and what is not
human marks a local grid. What a camera adds comes between `follow` and `mark_things`.
"""

import numpy as np

from ...slam.rigid_kernel import moved_points
from ...slam.view_kernel import inner_kernel, kernel
from . import leg_kernels, person_tracks, track_kernels
from .confirmation import confirm_people
from .leg_association import associate
from .leg_exchange import exchange
from .local_grid import mark
from .merged_legs import see_merged_legs
from .numbers import confidence_weight, process_variance
from .reidentification import lose, predict_lost
from .tracks import LEGS, LOST, PEOPLE, begin, count_owned, take


@kernel
def follow(tracks, found, points, pose, time_s, dt, c):
    """Take the clusters `found` in one scan, taken `dt` seconds after the last from `pose` (3,), T_odom_robot.

    `points` (k, 2) are the scan's in the odometry frame. Returns (m,) which of the clusters are not human: no leg-like
    ones, and old tentative tracks that never moved.
    """
    places, human = moved_points(pose, found.positions), np.flatnonzero(found.human)
    z, d = places[human], found.confidence[human]
    _predict(tracks, dt, c)
    match = associate(tracks, z, c)
    _correct(tracks, match, z, d, found, places, time_s, dt, c)
    match = exchange(tracks, match, c)
    things = _things(tracks, found.human, human, match, c)
    _terminate(tracks, c)
    fresh = leg_kernels.unmatched(match, len(z))
    begin(tracks, z[fresh], d[fresh], c.motion_initial_variance)
    confirm_people(tracks, points, time_s, c)
    return things


@kernel
def mark_things(tracks, found, points, things, pose, time_s, dt, c):
    """Mark the grid where the clusters `things` (m,) are, but never where a person, or what may become one, stands."""
    people, legs = tracks.people[: tracks.counts[PEOPLE]], tracks.legs[: tracks.counts[LEGS]]
    lost = tracks.lost["x"][: tracks.counts[LOST]]
    human = leg_kernels.human_places(people, legs, c.confirmation_delta / 2.0, lost)
    kept = track_kernels.points_of_things(points, found.start, found.end, things, human, c.grid_clearance)
    mark(tracks.cells, kept, pose, c.grid_resolution, time_s, dt / c.grid_rise_s, c.grid_fade_s)


@inner_kernel
def _predict(tracks, dt, c):
    """Move all tracks `dt` seconds ahead (eq. 4a, 4b)."""
    legs = tracks.legs[: tracks.counts[LEGS]]
    track_kernels.predict(legs["x"], legs["p"], legs["age_s"], legs["unseen_s"], dt, process_variance(c, dt))
    person_tracks.predict_people(tracks.people[: tracks.counts[PEOPLE]], dt, c)
    predict_lost(tracks, dt, c)


@inner_kernel
def _correct(tracks, match, z, d, found, places, time_s, dt, c):
    """Correct legs and people (eq. 4c to 4e, 6) with detections `z` (m, 2), `d` (m,) that `match` (n,) tracks."""
    legs, people = tracks.legs[: tracks.counts[LEGS]], tracks.people[: tracks.counts[PEOPLE]]
    track_kernels.correct_legs(legs, match, z, d, c.motion_r, confidence_weight(c, dt))
    seen = person_tracks.measure(people, match[: 2 * len(people)], z, d)
    see_merged_legs(tracks, seen.seen, seen.centre, seen.confidence, found, places, time_s, c)
    person_tracks.correct_people(people, seen, dt, c)
    leg_kernels.carry_hidden(legs, people, match)
    track_kernels.average_apart(legs["x"], legs["age_s"], tracks.apart, dt, c.pairing_stride_s)
    count_owned(tracks, dt)


@inner_kernel
def _things(tracks, is_human, human, match, c):
    """Return (m,) which clusters are not human; `human` (k,) are those of which `is_human` (m,) says they are."""
    legs, owned = tracks.legs[: tracks.counts[LEGS]], 2 * tracks.counts[PEOPLE]
    things = ~is_human
    still = leg_kernels.still(legs, owned, match, c.grid_still_s, c.confirmation_delta, len(human))
    track_kernels.put(still, is_human, things)
    return things


@inner_kernel
def _terminate(tracks, c):
    """End tracks whose place is too uncertain, or that nobody believes in; a person's legs live as long as the person.

    Ye 2021, section II.A.
    """
    people, legs = tracks.people[: tracks.counts[PEOPLE]], tracks.legs[: tracks.counts[LEGS]]
    alive = track_kernels.surviving(people, c.termination_epsilon, c.termination_c_min)
    keep = track_kernels.surviving(legs, c.termination_epsilon, c.termination_c_min)
    for i in range(len(alive)):
        keep[2 * i] = keep[2 * i + 1] = alive[i]
    if not alive.all():
        lose(tracks, alive, c)
    if not keep.all():
        take(tracks, np.flatnonzero(keep))
