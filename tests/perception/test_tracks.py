"""Rows of legs and people: what a step of the tracker asks of them, with answers known by hand."""

import numpy as np
import pytest
from tagalong.perception.tracking import leg_association, leg_kernels, track_kernels
from tagalong.perception.tracking.config import TrackerConfig
from tagalong.perception.tracking.leg_exchange import spread_of
from tagalong.perception.tracking.numbers import numbers_of
from tagalong.perception.tracking.person_tracks import Sightings, confirm, correct_people, measure, predict_people
from tagalong.perception.tracking.tracks import LEGS, PEOPLE, begin, no_tracks, tracks_of

CONFIG = TrackerConfig()
GATING, MOTION = CONFIG.gating, CONFIG.motion
NUMBERS = numbers_of(CONFIG)


def tracks(*places):
    made = tracks_of(no_tracks(1), 0)
    begin(made, np.array(places, dtype=np.float64), np.full(len(places), 0.8), MOTION.initial_variance)
    return made


def legs_of(made):
    return made.legs[: made.counts[LEGS]]


def person(offset=(0.1, 0.0)):
    made = tracks(*(np.array([2.0, 1.0]) + side * np.array(offset) for side in (1.0, -1.0)))
    legs_of(made)["confidence"], legs_of(made)["age_s"] = (0.9, 0.7), (2.0, 1.0)
    confirm(made, np.array([[0, 1]]), NUMBERS)
    return made.people[: made.counts[PEOPLE]]


def test_the_numbers_of_kernels_are_those_of_the_configuration():
    assert NUMBERS["gating_gate_max"] == GATING.gate_max
    assert NUMBERS["confirmation_unseen_s"] == CONFIG.confirmation.unseen_s
    assert NUMBERS["reidentification_unseen_s"] == CONFIG.reidentification.unseen_s
    assert all(NUMBERS.dtype[name] == np.float64 for name in NUMBERS.dtype.names)


def test_a_track_has_moved_as_far_as_the_box_around_its_places_is_large():
    legs = legs_of(tracks((1.0, 1.0)))
    for place in ((1.3, 1.0), (1.3, 0.6), (1.1, 0.9)):
        track_kernels.correct_legs(legs, np.array([0]), np.array([place]), np.array([0.9]), 0.1, 0.05)
    low, high = legs["low"][0], legs["high"][0]
    assert np.all(low < high)
    assert leg_kernels.moved(legs)[0] == pytest.approx(np.hypot(*(high - low)))
    leg_kernels.restart_moving(legs, 0)
    assert leg_kernels.moved(legs)[0] == 0.0
    np.testing.assert_array_equal(legs["first"][0], legs["x"][0, :2])


def test_how_far_two_tracks_stay_apart_is_the_length_of_their_mean_vector():
    made = tracks((1.0, 1.0), (1.3, 1.4), (-1.0, 1.0))
    np.testing.assert_allclose(
        spread_of(made), [[0.0, 0.5, 2.0], [0.5, 0.0, np.hypot(2.3, 0.4)], [2.0, np.hypot(2.3, 0.4), 0.0]]
    )
    x, age_s = legs_of(made)["x"], legs_of(made)["age_s"]
    for _ in range(50):  # legs that swing past each other are near in the mean
        x[1, :2] = 2.0 * x[0, :2] - x[1, :2]
        age_s += 0.1
        track_kernels.average_apart(x, age_s, made.apart, 0.1, CONFIG.pairing.stride_s)
    assert spread_of(made)[0, 1] < 0.1


def test_the_gate_opens_with_the_time_unseen_up_to_its_most():
    legs = legs_of(tracks((0.0, 0.0), (5.0, 0.0), (10.0, 0.0)))
    legs["unseen_s"] = [0.0, 0.1, 60.0]
    gates = leg_association.gates_of(legs, NUMBERS)
    assert gates.tolist() == pytest.approx([GATING.gate, GATING.gate + 0.1 * GATING.gate_speed, GATING.gate_max])
    assert gates[0] < gates[1] < gates[2]


def test_a_detection_is_of_the_track_within_whose_gate_it_is():
    made = tracks((0.0, 0.0), (5.0, 0.0))
    z = np.array([[5.0, -0.2], [0.1, 0.0], [2.5, 0.0]])
    assert leg_association.associate(made, z, NUMBERS).tolist() == [1, 0]
    assert leg_association.associate(made, z[2:], NUMBERS).tolist() == [-1, -1]


def test_a_person_is_born_between_the_legs_as_old_as_the_younger():
    people = person(offset=(0.1, 0.05))
    assert people["x"][0, :2] == pytest.approx([2.0, 1.0])
    assert people["offset"][0] == pytest.approx([0.1, 0.05])
    assert people["confidence"][0] == pytest.approx(0.8)
    assert people["age_s"][0] == 1.0
    assert np.isinf(people["camera_s"][0])


def test_two_legs_measure_the_centre_and_one_leg_less_its_offset():
    z, d = np.array([[2.1, 1.0], [1.9, 1.0]]), np.array([0.9, 0.5])
    both = measure(person(), np.array([0, 1]), z, d)
    assert both.centre[0] == pytest.approx([2.0, 1.0])
    assert not both.one_leg[0]
    first = measure(person(), np.array([0, -1]), z, d)
    second = measure(person(), np.array([-1, 1]), z, d)
    for seen in (first, second):
        assert seen.one_leg[0]
        assert seen.centre[0] == pytest.approx([2.0, 1.0])
    nothing = measure(person(), np.array([-1, -1]), z, d)
    assert not nothing.seen[0]
    assert nothing.confidence[0] == 0.0


def test_one_leg_moves_a_person_less_than_two():
    moved = []
    for one_leg in (False, True):
        people = person()
        seen = Sightings(np.array([True]), np.array([one_leg]), np.array([[2.3, 1.0]]), np.array([0.9]))
        correct_people(people, seen, 0.1, NUMBERS)
        moved.append(people["x"][0, 0] - 2.0)
    assert 0.0 < moved[1] < moved[0] < 0.3
    both, one = (0.05 / (0.05 + r) for r in (MOTION.r, MOTION.r + MOTION.one_leg_variance))
    assert moved == pytest.approx([0.3 * both, 0.3 * one], rel=1e-6)


def test_what_is_believed_of_the_offset_fades():
    people = person()
    predict_people(people, CONFIG.pairing.offset_s, NUMBERS)
    assert people["offset"][0] == pytest.approx([0.1 / np.e, 0.0])
    assert people["age_s"][0] == pytest.approx(1.0 + CONFIG.pairing.offset_s)


def test_legs_seen_now_say_whose_they_are(stage):
    history, truth = stage.walk([[1.0, -1.0]], [[0.0, 1.2]], 2.0)
    legs = history[-1].seen_legs
    assert legs.owner.tolist() == [0, 0]
    assert legs.positions.mean(axis=0) == pytest.approx(truth[-1][0], abs=0.2)
    loose = stage.show([[1.0, 1.5], [3.0, 0.0]]).seen_legs
    assert sorted(loose.owner.tolist()) == [-1, 0]  # the other leg was not seen
    assert loose.positions[loose.owner == -1][0] == pytest.approx([3.0, 0.0], abs=0.1)
    moved = stage.show([[1.0, 1.5], [3.0, 0.0]]).in_frame_of((1.0, 0.0, np.pi / 2.0)).seen_legs
    assert moved.positions[moved.owner == -1][0] == pytest.approx([0.0, -2.0], abs=0.1)
