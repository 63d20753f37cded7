"""Legs seen apart from the leader stay somebody else's; duplicate tracks of the leader are no other people."""

from dataclasses import replace

import numpy as np
import pytest
from tagalong.perception.leader.body_memory import memory_of, nothing_remembered
from tagalong.perception.leader.duplicate_tracks import DuplicateTracks
from tagalong.perception.leader.legs_of_others import SCANS, follow_legs, observe_apart, others_among
from tagalong.perception.tracking.people import People, SeenLegs

DT = 0.1


def asked(legs, places, own=(), explained=1.0):
    """Show legs at `places`, those of rows `own` carried by the leader's track; return which are others'."""
    follow_legs(legs, np.asarray(places, dtype=np.float64).reshape(-1, 2), DT)
    mine = np.isin(np.arange(len(places)), own)
    return others_among(legs, mine, np.where(mine, 1.0, explained), DT).tolist()


def seen_apart(times, place=(1.0, 0.0)):
    legs = memory_of(nothing_remembered(1, 1), 0)
    for _ in range(times):
        asked(legs, [place, (0.0, 0.0)])
        observe_apart(legs, np.array([True, False]))
    return legs


def test_a_leg_is_somebody_elses_after_three_scans_in_a_row_apart_from_the_leader():
    assert asked(seen_apart(2), [(1.0, 0.0), (0.0, 0.0)]) == [False, False]
    assert asked(seen_apart(3), [(1.0, 0.0), (0.0, 0.0)]) == [True, False]
    interrupted = seen_apart(2)
    asked(interrupted, [(1.0, 0.0), (0.0, 0.0)])
    observe_apart(interrupted, np.array([False, False]))
    for _ in range(2):
        asked(interrupted, [(1.0, 0.0), (0.0, 0.0)])
        observe_apart(interrupted, np.array([True, False]))
    assert asked(interrupted, [(1.0, 0.0), (0.0, 0.0)]) == [False, False]


def test_a_leg_of_somebody_else_is_followed_in_steps_that_a_leg_can_make():
    legs = seen_apart(3)
    assert asked(legs, [(0.8, 0.0), (0.0, 0.0)], own=[0]) == [True, False]
    assert asked(legs, [(0.6, 0.0), (0.0, 0.0)], own=[0]) == [True, False]
    assert asked(legs, [(0.3, 0.0), (-0.3, 0.0)], own=[0]) == [False, False]


@pytest.mark.parametrize(("hidden", "known"), [(3, True), (6, False)])
def test_a_leg_of_somebody_else_is_recognised_if_it_was_hidden_for_less_than_half_a_second(hidden, known):
    legs = seen_apart(3)
    for _ in range(hidden):
        asked(legs, [(0.0, 0.0)])
    followed = legs.followed["apart"][: legs.leader["followed"][0]]
    assert np.count_nonzero(followed >= SCANS) == int(known)
    assert asked(legs, [(1.1, 0.0), (0.0, 0.0)]) == [known, False]


def test_legs_of_the_leaders_own_track_are_its_own_after_all_when_there_are_no_others():
    legs, places = seen_apart(3), [(1.0, 0.0), (0.0, 0.0)]
    for _ in range(6):
        assert asked(legs, places, own=[0], explained=0.5) == [True, False]  # the other leg may be the leader's
    answers = [asked(legs, places, own=[0], explained=0.0)[0] for _ in range(6)]
    assert answers[:3] == [True] * 3
    assert not answers[-1]


def people_at(places, unseen_s=0.0):
    count, none = len(places), np.zeros((0, 2))
    return People(
        time_s=0.0,
        ids=np.arange(count),
        positions=np.asarray(places, dtype=np.float64).reshape(-1, 2),
        velocities=np.zeros((count, 2)),
        confidence=np.full(count, 0.8),
        legs=np.zeros((count, 2, 2)),
        variance=np.full(count, 0.05),
        unseen_s=np.array([0.0, unseen_s, 0.0][:count]),
        age_s=np.ones(count),
        seen_legs=SeenLegs(none, np.zeros(0), np.zeros(0, dtype=np.intp)),
    )


def watched(place, steps, **fields):
    duplicates = DuplicateTracks(0.4, 0.8, separation=0.8)
    for _ in range(steps):
        update(duplicates, people_at([(0.0, 0.0), place], **fields))
    return duplicates


def update(duplicates, people):
    """Compare those who are seen with the leader, who is the first."""
    duplicates.update(people, np.zeros(2), (people.ids != 0) & (people.unseen_s == 0.0), DT)


def test_who_is_tracked_at_the_leaders_place_for_long_is_a_duplicate():
    pair = people_at([(0.0, 0.0), (0.3, 0.0)])
    assert watched((0.3, 0.0), 10).among(pair).tolist() == [False, True]
    duplicates = watched((0.3, 0.0), 0)
    for _ in range(10):
        update(duplicates, people_at([(0.0, 0.0), (0.3, 0.0), (3.0, 0.0)]))
    assert duplicates.among(people_at([(0.0, 0.0), (0.3, 0.0), (3.0, 0.0)])).tolist() == [False, True, False]
    assert watched((0.3, 0.0), 7).among(pair).tolist() == [False, False]
    assert watched((0.5, 0.0), 10).among(pair).tolist() == [False, False]
    assert watched((0.3, 0.0), 10, unseen_s=0.2).among(pair).tolist() == [False, False]


def test_however_many_came_and_went_a_duplicate_is_known():
    duplicates, pair = watched((0.3, 0.0), 10), people_at([(0.0, 0.0), (0.3, 0.0)])
    for k in range(100):
        update(duplicates, replace(pair, ids=np.array([0, 10 + k])))
    assert duplicates.among(pair).tolist() == [False, True]
    assert duplicates.among(people_at([])).tolist() == []


def test_a_duplicate_seen_somewhere_else_is_somebody_else():
    duplicates = watched((0.3, 0.0), 10)
    update(duplicates, people_at([(0.0, 0.0), (0.6, 0.0)]))
    assert duplicates.among(people_at([(0.0, 0.0), (0.6, 0.0)])).tolist() == [False, True]
    update(duplicates, people_at([(0.0, 0.0), (0.9, 0.0)]))
    assert duplicates.among(people_at([(0.0, 0.0), (0.9, 0.0)])).tolist() == [False, False]
