"""The questions that the tracker asks its leg tracks, against plain numpy and by known answers."""

import leg_tracks_reference as leg_reference
import numpy as np
import pytest
from tagalong.perception.tracking import leg_kernels
from tagalong.perception.tracking.tracks import LEG, PERSON

LEGS, PEOPLE, DETECTIONS = 11, 3, 9


@pytest.fixture(params=range(6))
def drawn(request):
    """Legs, people, match, and the generator."""
    rng = np.random.default_rng(request.param)
    legs, people = np.zeros(LEGS, dtype=LEG), np.zeros(PEOPLE, dtype=PERSON)
    for rows in (legs, people):
        for name in set(rows.dtype.names) - {"id"}:
            rows[name] = rng.uniform(0.0, 2.0, rows[name].shape)
    legs["unseen_s"] *= rng.random(LEGS) < 0.5
    match = np.full(LEGS, -1)
    match[rng.permutation(LEGS)[:6]] = rng.permutation(DETECTIONS)[:6]
    return legs, people, match, rng


def test_questions_have_the_answers_of_plain_numpy(drawn):
    legs, people, match, rng = drawn
    lost = rng.normal(size=(2, 2))
    asked = {
        "moved": (legs,),
        "promising": (legs, 2 * PEOPLE, 1.0, 0.8),
        "still": (legs, 2 * PEOPLE, match, 0.8, 1.2, DETECTIONS),
        "human_places": (people, legs, 1.0, lost),
        "unmatched": (match, DETECTIONS),
        "seen_now": (legs, PEOPLE),
        "since_leg": (legs, PEOPLE),
    }
    for name, arguments in asked.items():
        ours, theirs = (getattr(module, name)(*arguments) for module in (leg_kernels, leg_reference))
        for one, other in zip(*((x if isinstance(x, tuple) else (x,)) for x in (ours, theirs)), strict=True):
            np.testing.assert_array_equal(one, other, err_msg=name)


def test_hidden_legs_are_carried_as_in_plain_numpy(drawn):
    legs, people, match, _ = drawn
    ours, theirs = legs.copy(), legs.copy()
    leg_kernels.carry_hidden(ours, people, match)
    leg_reference.carry_hidden(theirs, people, match)
    assert (ours["x"] != legs["x"]).any()
    np.testing.assert_array_equal(ours, theirs)


def test_a_still_thing_is_an_old_lone_track_that_has_not_moved():
    legs, match = np.zeros(5, dtype=LEG), np.array([0, 1, 2, 3, -1])
    legs["age_s"] = (9.0, 9.0, 9.0, 0.5, 9.0)  # owned, moved, still, young, unseen
    legs["high"][1, 0] = 1.0
    assert leg_kernels.still(legs, 1, match, 2.0, 0.3, 6).tolist() == [False, False, True, False, False, False]


def test_nobody_and_nothing_have_no_answers():
    legs, people, none = np.zeros(0, dtype=LEG), np.zeros(0, dtype=PERSON), np.zeros(0, dtype=np.int64)
    leg_kernels.carry_hidden(legs, people, none)
    assert len(leg_kernels.human_places(people, legs, 1.0, np.zeros((0, 2)))) == 0
    assert leg_kernels.unmatched(none, 3).tolist() == [0, 1, 2]
    assert leg_kernels.still(legs, 0, none, 1.0, 1.0, 2).tolist() == [False, False]
