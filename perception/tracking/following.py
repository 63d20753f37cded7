"""A scan's way through the stages of multi-target tracking, as two kernels.

Prediction, data association, correction and evidence in `follow`; beginning, ending, re-identification and the grid of
what stands still in `maintain`. What a camera adds comes between the two.
"""

import numpy as np

from ...slam.view_kernel import inner_kernel, kernel
from ..legs.recent_views import keep_view
from . import motion
from .association import associate
from .evidence import look, probability, seen_from, weigh_looks
from .existence import begin, believe, end, stood_where
from .geometry_kernels import points_of_things
from .local_grid import mark
from .numbers import process_variance
from .still_frame import unjudged
from .tracks import hypotheses_of


@kernel
def follow(tracks, found, view, pose, time_s, dt, c):
    """Take the clusters `found` in a scan with this `view`, `dt` seconds after the last; return what they show.

    `pose` (3,) is T_odom_robot.
    """
    rows, sight = hypotheses_of(tracks), look(tracks, found, view, pose, time_s, dt, c)
    motion.widen(rows, tracks.frame[0].laser, view.laser, unjudged(tracks.frame[0], c.frame_doubt))
    for k in range(3):
        tracks.frame[0].laser[k] = view.laser[k]
    motion.predict(rows, dt, process_variance(c, dt))
    associate(rows, sight, c)
    one_leg = c.motion_r + c.motion_one_leg_variance
    motion.correct(rows, sight.z, c.motion_r, one_leg, dt, np.exp(-dt / c.association_offset_s))
    for i in range(len(rows)):
        rows[i].placed_s = rows[i].placed_s + dt if rows[i].p[0] <= c.existence_told else 0.0
    _note_paths(tracks, rows, sight, view, time_s, dt, c)
    weigh_looks(rows, sight, view, dt, c)
    return sight


@inner_kernel
def _note_paths(tracks, rows, sight, view, time_s, dt, c):
    """Note where hypotheses have been; one that has stood for long is as if it had never moved."""
    free = stood_where(tracks, rows, sight, time_s, c) < c.things_still_s
    motion.note_path(
        rows, seen_from(view.laser, sight.z), free, sight.still, dt, c.views_spacing_s, c.evidence_least_way,
        c.evidence_least_pace, c.evidence_jitter,
    )  # fmt: skip
    for i in range(len(rows)):
        if rows[i].stands_s >= c.existence_stand_s:
            rows[i].moved, rows[i].born[0], rows[i].born[1] = 0.0, rows[i].x[0], rows[i].x[1]


@kernel
def maintain(tracks, sight, view, pose, points, time_s, dt, c):
    """Begin and end hypotheses by what was seen, and mark where things stand.

    `points` (k, 2) are the scan's, odometry frame [m].
    """
    begin(tracks, sight, view.laser, c)
    keep_view(tracks.views, view, time_s, c.views_spacing_s)
    end(tracks, sight, time_s, c)
    believe(tracks, time_s, c)
    _mark_things(tracks, points, pose, time_s, dt, c)


@inner_kernel
def _mark_things(tracks, points, pose, time_s, dt, c):
    """Mark where something stands by `points` (k, 2), but not where somebody who came is."""
    rows, count = hypotheses_of(tracks), 0
    people = np.empty((3 * len(rows), 2))
    for i in range(len(rows)):
        if rows[i].id >= 0 and rows[i].moved >= c.evidence_least_way:
            for k in range(2):
                people[count, k] = rows[i].x[k]
                people[count + 1, k] = rows[i].x[k] + rows[i].legs[0, k]
                people[count + 2, k] = rows[i].x[k] + rows[i].legs[1, k]
            count += 3
    whole = np.zeros(1, np.int64), np.full(1, len(points)), np.ones(1, np.bool_)
    things = points_of_things(points, whole[0], whole[1], whole[2], people[:count], c.things_clearance)
    mark(tracks.cells, things, pose, c.things_resolution, time_s, dt, c.things_forget_s)


@kernel
def told_people(rows, c):
    """Return (k,) which of the hypotheses `rows` (n,) are believed in, and of whom is known where they are."""
    told, count = np.empty(len(rows), np.int64), 0
    for i in range(len(rows)):
        if rows[i].id >= 0 and rows[i].p[0] <= c.existence_told:
            told[count] = i
            count += 1
    return told[:count]


@kernel
def seen_legs(rows, told, c):
    """Return places (k, 2), confidence (k,) and owner (k,) of the legs of `rows` (n,) that likelier are somebody's.

    The owner is a row of `told` (k,), or -1 for nobody.
    """
    owner_of = np.full(len(rows), -1)
    for k in range(len(told)):
        owner_of[told[k]] = k
    places, sure, owner = np.empty((2 * len(rows), 2)), np.empty(2 * len(rows)), np.empty(2 * len(rows), np.int64)
    count = 0
    for i in range(len(rows)):
        for s in range(2):
            if rows[i].clusters[s] >= 0 and rows[i].odds >= c.existence_stop:
                for k in range(2):
                    places[count, k] = rows[i].x[k] + rows[i].legs[s, k]
                sure[count], owner[count] = probability(rows[i].odds), owner_of[i]
                count += 1
    return places[:count], sure[:count], owner[:count]
