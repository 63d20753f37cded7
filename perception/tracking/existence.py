"""Track maintenance: where hypotheses begin, when they are people, and when they end (`ExistenceConfig`)."""

from typing import Any

import numpy as np

from ...slam.view_kernel import inner_kernel, kernel
from .evidence import log_odds, seen_from
from .local_grid import stood_for
from .reidentification import lose, nearest_lost, taken
from .tracks import HYPOTHESES, NEXT_ID, NEXT_SERIAL, hypotheses_of, keep_hypotheses

LONG_AGO_S = 1e3
"""A leg that was never seen is as uncertain as one that was last seen so long ago."""


@inner_kernel
def begin(tracks, sight, laser, c):
    """Begin hypotheses at clusters that no hypothesis explains, seen from `laser` (3,), but not at things."""
    z, order = sight.z, np.argsort(-sight.first, kind="mergesort")
    able = (sight.affinity >= c.existence_begin) & (sight.still * sight.stood < c.existence_stand_s)
    found = fresh_clusters(hypotheses_of(tracks), z, order, able, c.existence_merge, c.existence_own)
    for k in range(len(found)):
        a, b = found[k, 0], found[k, 1]
        other = b if b >= 0 else a
        x, y = 0.5 * (z[a, 0] + z[other, 0]), 0.5 * (z[a, 1] + z[other, 1])
        one = begin_at(tracks, x, y, laser, c)
        one.evidence = sight.first[a] + (min(sight.second[a], sight.second[b]) if b >= 0 else 0.0)
        leg = seen_from(laser, z[a : a + 1])
        one.seen[0, 0], one.seen[0, 1], one.places = leg[0, 0], leg[0, 1], 1
        one.path[0, 0], one.path[0, 1] = x, y
        one.clusters[0], one.clusters[1] = a, b
        one.legs[0, 0], one.legs[0, 1] = z[a, 0] - x, z[a, 1] - y
        one.legs[1, 0], one.legs[1, 1] = z[other, 0] - x, z[other, 1] - y
        one.leg_unseen_s[0], one.leg_unseen_s[1] = 0.0, (0.0 if b >= 0 else LONG_AGO_S)


@inner_kernel
def begin_at(tracks, x, y, laser, c):
    """Begin a hypothesis at (x, y), seen from `laser` (3,), of which no leg is known; return it."""
    row = tracks.counts[HYPOTHESES]
    tracks.counts[HYPOTHESES] = row + 1
    one = tracks.hypotheses[row]
    one.id, one.serial, one.looks, one.odds = -1, tracks.counts[NEXT_SERIAL], 1.0, 0.0
    tracks.counts[NEXT_SERIAL] += 1
    one.x[0], one.x[1], one.x[2], one.x[3] = x, y, 0.0, 0.0
    one.p[0], one.p[1], one.p[2] = c.motion_initial_variance, 0.0, 4.0 * c.motion_initial_variance
    one.moved = one.swing = one.missing = one.marked_s = one.stands_s = 0.0
    one.age_s = one.placed_s = one.unseen_s = 0.0
    one.places = 0
    viewed = seen_from(laser, np.array([[x, y]]))
    for k in range(2):
        one.born[k] = one.stood[k] = one.x[k]
        one.viewed[k], one.clusters[k], one.leg_unseen_s[k] = viewed[0, k], -1, LONG_AGO_S
        one.legs[k, 0] = one.legs[k, 1] = 0.0
    return one


@inner_kernel
def end(tracks, sight, time_s, c):
    """End duplicates, and hypotheses that nobody believes in or that are things by now."""
    rows = hypotheses_of(tracks)
    odds = log_odds(rows, c.evidence_prior, c.evidence_alike, c.evidence_moved, c.evidence_least_way)
    stood = stood_where(tracks, rows, sight, time_s, c)
    for i in range(len(rows)):
        still = max(stood[i], rows[i].stands_s) / c.existence_stand_s
        if stood[i] >= c.things_still_s or (rows[i].age_s < c.things_still_s and not has_come(rows[i], sight)):
            still += 2.0 * c.existence_memory
        odds[i] -= sight.still * still
        rows[i].odds = odds[i]
    keep = without_duplicates(rows, odds, c.existence_merge, c.existence_own)
    for i in range(len(rows)):
        one = rows[i]
        keep[i] = keep[i] and one.p[0] <= c.existence_vague
        if one.id >= 0:
            keep[i] = keep[i] and odds[i] >= c.existence_stop
        else:
            keep[i] = keep[i] and one.unseen_s <= c.existence_tentative_s
            keep[i] = keep[i] and sight.still * stood[i] < c.existence_stand_s
    lose(tracks, rows, keep, time_s, c)
    keep_hypotheses(tracks, keep)


@inner_kernel
def stood_where(tracks, rows, sight, time_s, c):
    """Return (n,) for how long something has stood where `rows` (n,) are: at all of their legs that are seen [s]."""
    stood = stood_for(tracks.cells, rows["x"][:, :2].copy(), c.things_resolution, time_s, c.things_forget_s)
    for i in range(len(rows)):
        a, b = rows[i].clusters[0], rows[i].clusters[1]
        if a >= 0 or b >= 0:
            stood[i] = min(sight.stood[a] if a >= 0 else np.inf, sight.stood[b] if b >= 0 else np.inf)
    return stood


@inner_kernel
def has_come(one, sight):
    """Return whether nothing at all was there a moment ago where a leg of hypothesis `one` is seen."""
    a, b = one.clusters[0], one.clusters[1]
    return (a >= 0 and sight.came[a]) or (b >= 0 and sight.came[b])


@inner_kernel
def believe(tracks, time_s, c):
    """Give a number to those who are people now; somebody lost is found again sooner, under the old number."""
    rows = hypotheses_of(tracks)
    for i in range(len(rows)):
        one = rows[i]
        if one.id >= 0 or one.odds < c.existence_start - c.existence_again:
            continue
        lost = nearest_lost(tracks, one, time_s, c)
        if lost >= 0:
            one.id = taken(tracks, lost)
        elif one.odds >= c.existence_start:
            one.id = tracks.counts[NEXT_ID]
            tracks.counts[NEXT_ID] += 1


@kernel
def fresh_clusters(rows: Any, z: Any, order: Any, able: Any, merge: float, own: float) -> Any:
    """Return (k, 2) clusters that begin new hypotheses, and the nearest that may be the other leg of each or -1.

    Args:
        rows: (n,) hypotheses, with their clusters.
        z: (m, 2) clusters [m].
        order: (m,) rows of the clusters, the surest leg first.
        able: (m,) whether each may begin a hypothesis; overwritten.
        merge: None begins so near to a hypothesis [m].
        own: Nor so near to a person; two legs of one person are no farther apart [m].
    """
    for i in range(len(rows)):
        limit = own if rows["id"][i] >= 0 else merge
        for j in range(len(z)):
            dx, dy = z[j, 0] - rows["x"][i, 0], z[j, 1] - rows["x"][i, 1]
            if dx * dx + dy * dy < limit * limit or j == rows["clusters"][i, 0] or j == rows["clusters"][i, 1]:
                able[j] = False
    found = np.empty((len(z), 2), np.int64)
    count = 0
    for j in order:
        if not able[j]:
            continue
        able[j] = False
        mate, nearest = -1, own
        for k in range(len(z)):
            apart = np.sqrt((z[k, 0] - z[j, 0]) ** 2 + (z[k, 1] - z[j, 1]) ** 2)
            if able[k] and apart < nearest:
                mate, nearest = k, apart
        if mate >= 0:
            able[mate] = False
        found[count, 0], found[count, 1] = j, mate
        count += 1
    return found[:count]


@kernel
def without_duplicates(rows: Any, odds: Any, merge: float, own: float) -> Any:
    """Return (n,) which hypotheses stay where two are nearer than `merge` [m], or one than `own` to a person.

    People stay before others, and likelier ones, by `odds` (n,), before others.
    """
    keep = np.ones(len(rows), np.bool_)
    for i in range(len(rows)):
        for j in range(len(rows)):
            known_i, known_j = rows["id"][i] >= 0, rows["id"][j] >= 0
            if i == j or (known_j and not known_i) or (known_i == known_j and (odds[j], i) > (odds[i], j)):
                continue
            limit = merge if known_i == known_j else own
            dx, dy = rows["x"][i, 0] - rows["x"][j, 0], rows["x"][i, 1] - rows["x"][j, 1]
            if keep[i] and dx * dx + dy * dy < limit * limit:
                keep[j] = False
    return keep
