"""The leader known by its body, scan by scan, in three kernels between which the cloud's random numbers are drawn.

`meet` takes the scan; where it leaves a doubt, `look` lets the cloud of bodies see it, and `decide` says who leads.
"""

from typing import NamedTuple

import numpy as np

from ...slam.view_kernel import inner_kernel, kernel
from ..tracking.geometry_kernels import distance
from . import cloud, cloud_kernels
from .body_memory import CHOSEN, CLOUD, FRESH, NOBODY, SETTLED, met_by
from .legs_of_others import SCANS, follow_legs, observe_apart, others_among
from .onset import choice


class BodyNumbers(NamedTuple):
    """Numbers of `CloudConfig` ("cloud_..."), `BodyConfig` and `LeaderConfig`, as kernels take them."""

    cloud_push: float
    cloud_calm_s: float
    cloud_top_speed: float
    cloud_place_deviation: float
    cloud_velocity_deviation: float
    cloud_leg_deviation: float
    cloud_most: float
    cloud_hidden: float
    cloud_empty: float
    cloud_instead: float
    cloud_resample: float
    alone: float
    own_weight: float
    weight: float
    sure: float
    other_claim: float
    own_claim: float
    other_deviation: float
    forget_s: float
    newborn_s: float
    known_again: float
    known_apart: float
    followed_apart: float
    radius: float
    take: float
    keep: float
    lead: float
    drop: float
    patience_s: float
    gathered: float
    loose_confidence: float
    beside: float
    exchange_s: float
    exchange_wait_s: float
    walks: float
    onset_s: float
    onset_near: float
    onset_far: float
    onset_patience_s: float


@kernel
def meet(memory, company, robot, time_s, c):
    """Take who is in `company` at `time_s`, seen from `robot` (2,); return what doubt is left of who leads."""
    one = memory.leader[0]
    one.dt, one.time_s = time_s - one.time_s, time_s
    follow_legs(memory, company.places, one.dt)
    apart = np.empty(len(company.ids))
    for i in range(len(apart)):
        apart[i] = np.hypot(company.x[i, 0] - robot[0], company.x[i, 1] - robot[1])
    nearest, one.chosen_s, one.waiting_s = choice(
        apart, time_s, one.known, one.chosen_s, one.waiting_s, c.onset_s, c.onset_near, c.onset_far, c.onset_patience_s
    )
    one.doubt, one.row = SETTLED, NOBODY
    if nearest >= 0:
        one.known, one.cloud, one.doubt, one.id = True, False, CHOSEN, company.ids[nearest]
        _carry(one, company, nearest)
    elif one.known:
        for i in range(len(apart) - 1, -1, -1):
            if company.ids[i] == one.own:
                one.row = i
        if one.track_id == one.own and _is_alone(memory, company, one.row, c.alone):
            one.cloud = False
            _carry(one, company, one.row)
        else:
            one.doubt = CLOUD if one.cloud else FRESH
    return one.doubt


@inner_kernel
def _carry(one, company, i):
    """Let person i of the company be the leader."""
    one.own = one.track_id = company.ids[i]
    for k in range(4):
        one.x[k] = company.x[i, k]
    one.visible, one.unseen_s = company.unseen_s[i] == 0.0, company.unseen_s[i]
    one.confidence = company.confidence[i]


@inner_kernel
def _is_alone(memory, company, own, alone):
    """Return whether person `own` is seen, with nobody and nobody's legs nearer than `alone` [m]."""
    if own < 0 or company.unseen_s[own] > 0.0:
        return False
    x, y = company.x[own, 0], company.x[own, 1]
    for i in range(len(company.ids)):
        if i != own and _within(company.x[i, 0], company.x[i, 1], x, y, alone):
            return False
    for j in range(len(company.owner)):
        if company.owner[j] != own and _within(company.places[j, 0], company.places[j, 1], x, y, alone):
            return False
    for i in range(memory.leader[0].followed):
        leg = memory.followed[i]
        if leg.apart >= SCANS and _within(leg.place[0], leg.place[1], x, y, alone):
            return False
    return True


@inner_kernel
def _within(x, y, u, v, reach):
    return (x - u) * (x - u) + (y - v) * (y - v) <= reach**2


@kernel
def look(memory, company, view, first, pushes, c):
    """Let the cloud see the scan; return whether its bodies are to be drawn anew.

    Args:
        memory: Of the selector; there is a doubt.
        company: Who is tracked.
        view: How far the laser sees.
        first: (n, 4) standard normal numbers, for a new cloud; else not looked at.
        pushes: (n, 2) likewise, for any.
        c: Numbers of the selector.
    """
    one, bodies, weights = memory.leader[0], memory.bodies, memory.weights
    if one.doubt == FRESH:
        cloud.begin_cloud(bodies, weights, one.x, first, c)
        one.cloud = True
    cloud.advance_cloud(bodies, weights, pushes, one.dt, view, c)
    legs, own = len(company.owner), one.row
    _free(memory, company, c)
    places, count = np.empty((legs + 1, 2)), np.empty(legs + 1)
    apart = own >= 0 and company.unseen_s[own] == 0.0  # seen, though both legs were seen as one
    for j in range(legs):
        places[j, 0], places[j, 1] = company.places[j, 0], company.places[j, 1]
        weight = c.own_weight if company.owner[j] == own else c.weight
        count[j] = weight * min(company.sure[j] / c.sure, 1.0) * memory.free[j]
        apart = apart and company.owner[j] != own
    if apart:
        places[legs, 0], places[legs, 1], count[legs] = company.x[own, 0], company.x[own, 1], c.own_weight
        legs += 1
    return cloud.weigh_cloud(bodies, weights, places[:legs], count[:legs], view, c)


@inner_kernel
def _free(memory, company, c):
    """Write how likely each of the legs is the leader's, by who else explains it."""
    one, legs = memory.leader[0], company.places
    claim, explained = np.zeros(len(legs)), np.empty(len(legs))
    if one.begun:
        _claim(memory, company, claim, c)
    cloud_kernels.explained(memory.bodies, memory.weights, legs, c.cloud_leg_deviation, explained)
    explained += 1e-6
    claim[others_among(memory, company.owner == one.row, explained, one.dt)] = c.other_claim
    for j in range(len(legs)):
        memory.free[j] = explained[j] / (explained[j] + claim[j])


@inner_kernel
def _claim(memory, company, claim, c):
    """Write into `claim` (k,) what right others have to the legs."""
    one, legs, owner = memory.leader[0], company.places, company.owner
    places, seen, count = np.empty((one.people, 2)), np.empty(one.people), 0
    for i in range(one.people):
        person = memory.before[i]
        if person.id == one.own:
            continue
        for k in range(2):
            places[count, k] = person.x[k] + one.dt * person.x[k + 2]
        known = one.time_s - _met_s(memory, person.id) > c.newborn_s
        seen[count] = np.exp(-person.unseen_s / c.forget_s) if known else 0.0
        count += 1
    rights = c.own_claim, c.other_claim, c.other_deviation
    cloud_kernels.claimed(legs, owner, one.row, places[:count], seen[:count], rights[0], rights[1], rights[2], claim)
    for j in range(len(legs)):
        if owner[j] < 0:
            claim[j] = _nearest(legs[j, 0], legs[j, 1], memory.others[: one.others]) < c.known_again


@inner_kernel
def _met_s(memory, number):
    """Return when the one of that `number` was first seen [s]."""
    one = memory.leader[0]
    for row in range(one.met - 1, -1, -1):
        if memory.met[row].number == number:
            return memory.met[row].met_s
    return np.inf


@inner_kernel
def _nearest(x, y, places):
    """Return how far the nearest of `places` (n, 2) is from (x, y) [m]."""
    least = np.inf
    for i in range(len(places)):
        least = min(least, distance(x, y, places[i, 0], places[i, 1]))
    return least


@kernel
def decide(memory, company, draw, c):
    """Say who leads, and remember what the next scan asks for.

    Args:
        memory: Of the selector.
        company: Who is tracked.
        draw: In [0, 1), for bodies that are drawn anew; negative: they are not.
        c: Numbers of the selector.
    """
    one = memory.leader[0]
    if one.doubt >= CLOUD:
        if draw >= 0.0:
            cloud.draw_anew(memory.bodies, memory.weights, draw)
        _decide(memory, company, c)
    if one.known and one.doubt != CHOSEN:
        _keep_others(memory, company, c)
    _note_people(memory, company, c)
    one.begun, one.people = True, len(company.ids)
    for i in range(one.people):
        memory.before[i].id, memory.before[i].unseen_s = company.ids[i], company.unseen_s[i]
        for k in range(4):
            memory.before[i].x[k] = company.x[i, k]


@inner_kernel
def _decide(memory, company, c):
    """Let the cloud say who leads: the one that most of it is at."""
    one, bodies, weights, own = memory.leader[0], memory.bodies, memory.weights, memory.leader[0].row
    share = np.empty(len(company.ids))
    cloud_kernels.mass_near(bodies, weights, company.x, c.radius, share)
    best, most, kept = -1, -1.0, 0.0
    for i in range(len(share)):
        able = share[i] if company.unseen_s[i] < c.patience_s else 0.0
        if able > most:
            best, most = i, able
        if i == own:
            kept = able
    exchanged = _exchanged(memory, company, c) if one.unseen_s > c.exchange_wait_s else NOBODY
    if own >= 0 and kept > c.keep and kept >= most - c.lead:
        _carry(one, company, own)
    elif best >= 0 and most > c.take:
        _carry(one, company, best)
    elif exchanged >= 0:
        _carry(one, company, exchanged)
        one.cloud = False
    else:
        if own >= 0 and company.unseen_s[own] == 0.0 and share[own] < c.drop:
            one.own = -1
        _lose(memory, company, c)


@inner_kernel
def _exchanged(memory, company, c):
    """Return who is in view and was the last to be beside the leader, shortly before it was lost; -1 for nobody.

    Tracks are exchanged where two people are beside each other. Of two that were so, one is the leader: where its own
    track is lost, the other's, if that one walks.
    """
    one, found, latest = memory.leader[0], -1, memory.leader[0].time_s - memory.leader[0].unseen_s - c.exchange_s
    for i in range(len(company.ids)):
        speed = np.hypot(company.x[i, 2], company.x[i, 3])
        if company.unseen_s[i] > 0.0 or company.ids[i] == one.own or speed < c.walks:
            continue
        for row in range(one.met - 1, -1, -1):
            if memory.met[row].number == company.ids[i] and memory.met[row].beside_s > latest:
                found, latest = i, memory.met[row].beside_s
    return found


@inner_kernel
def _lose(memory, company, c):
    """Let the leader be where the cloud is: seen, if the cloud has gathered around legs that are nobody's."""
    one, mean, gathered = memory.leader[0], cloud.mean_of(memory.bodies, memory.weights), False
    if cloud.spread_of(memory.bodies, memory.weights) < c.gathered:
        for j in range(len(company.owner)):
            away = np.hypot(company.places[j, 0] - mean[0], company.places[j, 1] - mean[1])
            gathered = gathered or (memory.free[j] > 0.5 and away < c.radius)
    for k in range(4):
        one.x[k] = mean[k]
    one.track_id, one.visible = -1, gathered
    one.confidence, one.unseen_s = (c.loose_confidence, 0.0) if gathered else (0.0, one.unseen_s + one.dt)


@inner_kernel
def _keep_others(memory, company, c):
    """Keep the places of legs that are nobody's and not the leader's, while it is in view; follow them later."""
    one, legs, owner = memory.leader[0], company.places, company.owner
    before, count = memory.others[: one.others].copy(), 0
    if one.visible:
        apart = np.empty(len(owner))
        for j in range(len(owner)):
            apart[j] = np.hypot(legs[j, 0] - one.x[0], legs[j, 1] - one.x[1])
        observe_apart(memory, (owner < 0) & (apart > c.followed_apart))
        count = _collect(memory, legs[(owner < 0) & (apart > c.known_apart)], 0)
    elif len(before) and (owner < 0).any():
        loose = legs[owner < 0]
        still, gone = np.empty(len(loose), np.bool_), np.empty(len(before), np.bool_)
        for j in range(len(loose)):
            still[j] = _nearest(loose[j, 0], loose[j, 1], before) < c.known_again
        for i in range(len(before)):
            gone[i] = _nearest(before[i, 0], before[i, 1], loose) >= c.known_again
        count = _collect(memory, before[gone], _collect(memory, loose[still], 0))
    else:
        count = one.others
    one.others = count


@inner_kernel
def _collect(memory, places, count):
    """Write `places` (n, 2) behind the first `count` others; return how many there are."""
    for i in range(len(places)):
        memory.others[count + i, 0], memory.others[count + i, 1] = places[i, 0], places[i, 1]
    return count + len(places)


@inner_kernel
def _note_people(memory, company, c):
    """Note when each was first seen, and when beside the leader.

    Who is there while the leader is in view is somebody else for good.
    """
    one = memory.leader[0]
    in_view = one.known and one.visible
    for i in range(len(company.ids)):
        one.met = met_by(memory.met, one.met, company.ids[i])
        if in_view or memory.met[one.met - 1].met_s == np.inf:
            memory.met[one.met - 1].met_s = -np.inf if in_view else one.time_s
        other = one.known and one.unseen_s < c.exchange_wait_s and company.ids[i] != one.track_id
        if other and _within(company.x[i, 0], company.x[i, 1], one.x[0], one.x[1], c.beside):
            memory.met[one.met - 1].beside_s = one.time_s
