"""Legs seen apart from the leader stay somebody else's; everybody who was tracked is remembered."""

import numpy as np
import pytest
from tagalong.perception.leader.body_memory import ACQUAINTANCE, memory_of, met_by, nothing_remembered
from tagalong.perception.leader.legs_of_others import SCANS, follow_legs, observe_apart, others_among

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


def test_however_many_came_and_went_everybody_is_known_and_who_was_here_last_is_found_first():
    met, count = np.zeros(64, ACQUAINTANCE), 0
    for k in (*range(50), 7):
        count = met_by(met, count, k)
        met[count - 1]["met_s"] = min(met[count - 1]["met_s"], 0.1 * k)
    assert count == 50
    assert met["number"][:50].tolist() == [*range(7), 49, *range(8, 49), 7]
    np.testing.assert_allclose(met["met_s"][:50], 0.1 * met["number"][:50])
    assert (met["beside_s"][:50] == -np.inf).all()
