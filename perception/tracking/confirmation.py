"""Track confirmation: which tentative leg tracks are people (Ye 2021, section II.A).

People are made of tentative leg tracks that moved as people do: of pairs of legs, and of single legs that are sure.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...slam.view_kernel import inner_kernel
from . import leg_kernels, track_kernels
from .local_grid import are_free
from .pairing import mutual_pairs
from .person_tracks import confirm
from .reidentification import may_be_legs
from .tracks import LEGS, LOST, PEOPLE, take


class LoneLegs(NamedTuple):
    """Tentative leg tracks that may be legs of somebody.

    Attributes:
        rows: (k,) of the leg tracks.
        moved: (k,) how far each has moved [m].
        known: (k,) whether it may be a leg of somebody to be re-identified, who has moved before.
        sure: (k,) whether its confidence is high.
    """

    rows: NDArray[np.int64]
    moved: NDArray[np.float64]
    known: NDArray[np.bool_]
    sure: NDArray[np.bool_]


@inner_kernel
def confirm_people(tracks, points, time_s, c):
    """Confirm people among the tentative tracks; the scan at `time_s` shows `points` (n, 2), odometry frame."""
    legs, owned = tracks.legs[: tracks.counts[LEGS]], 2 * tracks.counts[PEOPLE]
    delta, c_min, unseen_s = c.confirmation_delta, c.termination_c_min, c.confirmation_unseen_s
    if tracks.counts[LOST] == 0 and not track_kernels.any_moved(legs, owned, delta / 2.0, c_min, unseen_s):
        return
    rows = leg_kernels.promising(legs, owned, c_min, unseen_s)
    moved, known = leg_kernels.moved(legs)[rows], may_be_legs(tracks, rows, c)
    if not (known | (moved >= delta / 2.0)).any():
        return
    sure = legs["confidence"][rows] >= c.confirmation_sure_confidence
    _confirm_pairs(tracks, LoneLegs(rows, moved, known, sure), points, time_s, c)
    _confirm_one_leg(tracks, points, time_s, c)


@inner_kernel
def _confirm_pairs(tracks, among, points, time_s, c):
    """Confirm each pair that is leg-like (gamma) in the mean over time, stands on free cells, and belongs together.

    Two legs belong together if each is the other's nearest in the mean over a stride.
    """
    legs, rows = tracks.legs, among.rows
    confidence, x = legs["confidence"], legs["x"]
    spread = track_kernels.spread_among(tracks.apart, x, rows, c.pairing_distance)
    pairs = mutual_pairs(spread, c.pairing_width)
    leg_like = np.empty(len(pairs), np.bool_)
    for k in range(len(pairs)):
        least = min(confidence[rows[pairs[k, 0]]], confidence[rows[pairs[k, 1]]])
        leg_like[k] = least >= c.confirmation_gamma
    pairs = pairs[leg_like]
    if len(pairs) == 0:
        return
    pairs = pairs[_moved_together(tracks, among, pairs, points, time_s, c)]
    free = np.empty(len(pairs), np.bool_)
    for k in range(len(pairs)):
        pairs[k, 0], pairs[k, 1] = rows[pairs[k, 0]], rows[pairs[k, 1]]
        free[k] = are_free(tracks.cells, x[pairs[k]], c.grid_resolution, time_s, c.grid_fade_s).all()
    confirm(tracks, pairs[free], c)


@inner_kernel
def _moved_together(tracks, among, pairs, points, time_s, c):
    """Return (k,) whether both legs of each of `pairs` (k, 2) of the candidates moved `delta` in the mean.

    So the longer way of one leg makes up for the other, whose track was renewed on the way. Two sure legs need half as
    much, and one of them may stand while the other swings past it. Who is known has moved before.
    """
    moved, known, sure, delta = among.moved, among.known, among.sure, c.confirmation_delta
    moves, count = moved > c.confirmation_origin_radius, len(pairs)
    together, asked = np.zeros(count, np.bool_), np.zeros(len(moved), np.bool_)
    for k in range(count):
        a, b = pairs[k, 0], pairs[k, 1]
        first, second = max(moved[a], delta) if known[a] else moved[a], max(moved[b], delta) if known[b] else moved[b]
        together[k] = first + second >= (delta if sure[a] and sure[b] else 2.0 * delta)
        if together[k]:
            asked[a] = asked[b] = True
    asked &= moves & ~known
    left = np.ones(len(moved), np.bool_)
    track_kernels.put(_left_origin(tracks, among.rows[asked], points, time_s, c), asked, left)
    went = known | (moves & left)
    for k in range(count):
        a, b = pairs[k, 0], pairs[k, 1]
        walked = (sure[a] and sure[b]) or (went[a] and went[b])
        together[k] = together[k] and left[a] and left[b] and walked
    return together


@inner_kernel
def _left_origin(tracks, rows, points, time_s, c):
    """Return (k,) whether none of the scan's `points` (n, 2), odometry frame, is where the leg tracks `rows` began.

    That tells legs that walked from tracks that hopped from one thing to the next, e.g. from chair leg to chair leg. A
    track that hopped has moved, but what it began at still stands there. Where that is known to be no human, the track
    begins anew where it is now.
    """
    legs = tracks.legs
    first = legs["first"][rows]
    left = np.ones(len(rows), np.bool_)
    for k in range(len(rows)):
        x, y = first[k, 0], first[k, 1]
        for i in range(len(points)):
            if track_kernels.distance(x, y, points[i, 0], points[i, 1]) <= c.confirmation_origin_radius:
                left[k] = False
                break
    free = are_free(tracks.cells, first[~left], c.grid_resolution, time_s, c.grid_fade_s)
    for i in rows[~left][~free]:
        leg_kernels.restart_moving(legs, i)
    return left


@inner_kernel
def _confirm_one_leg(tracks, points, time_s, c):
    """Re-identify somebody of whom one leg is seen, or confirm a sure leg that moved for both.

    It stands on a free cell; the other leg counts as hidden by it, or by what stands before it.
    """
    legs, owned = tracks.legs[: tracks.counts[LEGS]], 2 * tracks.counts[PEOPLE]
    far, sure, age_s = 2.0 * c.confirmation_delta, c.confirmation_sure_confidence, c.reidentification_one_leg_age_s
    lost = tracks.lost[: tracks.counts[LOST]]
    if len(lost) == 0 and not track_kernels.any_sure_walker(legs, owned, far, sure, age_s):
        return
    rows = owned + np.flatnonzero((legs["unseen_s"][owned:] == 0.0) & (legs["age_s"][owned:] >= age_s))
    known = may_be_legs(tracks, rows, c)
    walked = ~known & (leg_kernels.moved(legs)[rows] >= far) & (legs["confidence"][rows] >= sure)
    track_kernels.put(_left_origin(tracks, rows[walked], points, time_s, c), walked, walked)
    rows = rows[known | walked]
    rows = rows[are_free(tracks.cells, legs["x"][rows], c.grid_resolution, time_s, c.grid_fade_s)]
    if len(rows) == 0:
        return
    chosen, least, x, ended = rows[0], np.inf, legs["x"], lost["x"]
    for i in rows:
        for j in range(len(lost)):
            away = track_kernels.distance(x[i, 0], x[i, 1], ended[j, 0], ended[j, 1])
            if away < least:
                chosen, least = i, away
    count = len(legs)
    take(tracks, np.append(np.arange(count), chosen))
    pair = np.empty((1, 2), np.int64)
    pair[0, 0], pair[0, 1] = chosen, count
    confirm(tracks, pair, c)
