"""Rows of legs and people: what a step of the tracker asks of them, with answers known by hand."""

import numpy as np
import pytest
from tagalong.perception.tracking import person_tracks
from tagalong.perception.tracking.config import TrackerConfig
from tagalong.perception.tracking.leg_tracks import LEG, LegTracks

CONFIG = TrackerConfig()
GATING, MOTION = CONFIG.gating, CONFIG.motion


def tracks(*places):
    legs = LegTracks(CONFIG)
    legs.begin(np.array(places, dtype=np.float64), np.full(len(places), 0.8))
    return legs


def person(offset=(0.1, 0.0)):
    pair = np.zeros((1, 2), dtype=LEG)
    pair["x"][0, :, :2] = np.array([[2.0, 1.0], [2.0, 1.0]]) + np.array([[1.0], [-1.0]]) * offset
    pair["p"] = (0.05, 0.0, 0.05)
    pair["confidence"] = [[0.9, 0.7]]
    pair["age_s"] = [[2.0, 1.0]]
    return person_tracks.new_people(pair)


def test_a_track_has_moved_as_far_as_the_box_around_its_places_is_large():
    legs = tracks((1.0, 1.0))
    for place in ((1.3, 1.0), (1.3, 0.6), (1.1, 0.9)):
        legs.correct(np.array([0]), np.array([place]), np.array([0.9]), 0.1)
    low, high = legs.rows["low"][0], legs.rows["high"][0]
    assert np.all(low < high)
    assert legs.moved[0] == pytest.approx(np.hypot(*(high - low)))
    legs.restart_moving(np.array([0]))
    assert legs.moved[0] == 0.0


def test_how_far_two_tracks_stay_apart_is_the_length_of_their_mean_vector():
    legs = tracks((1.0, 1.0), (1.3, 1.4), (-1.0, 1.0))
    np.testing.assert_allclose(
        legs.spread(), [[0.0, 0.5, 2.0], [0.5, 0.0, np.hypot(2.3, 0.4)], [2.0, np.hypot(2.3, 0.4), 0.0]]
    )
    for _ in range(50):  # legs that swing past each other are near in the mean
        legs.rows["x"][1, :2] = 2.0 * legs.positions[0] - legs.positions[1]
        legs.predict(0.1)
        legs.measure_apart(0.1)
    assert legs.spread()[0, 1] < 0.1


def test_the_gate_opens_with_the_time_unseen_up_to_its_most():
    legs = tracks((0.0, 0.0), (5.0, 0.0), (10.0, 0.0))
    legs.rows["unseen_s"] = [0.0, 0.1, 60.0]
    _, gates = legs.cost(np.zeros((1, 2)), np.zeros((0, 2)))
    assert gates.tolist() == pytest.approx([GATING.gate, GATING.gate + 0.1 * GATING.gate_speed, GATING.gate_max])
    assert gates[0] < gates[1] < gates[2]


def test_the_cost_of_a_detection_is_its_distance_and_infinite_beyond_the_gate():
    legs = tracks((0.0, 0.0), (5.0, 0.0))
    cost, gates = legs.cost(np.array([[0.1, 0.0], [5.0, -0.2]]), np.zeros((0, 2)))
    assert cost[0, 0] == pytest.approx(0.1)
    assert cost[1, 1] == pytest.approx(0.2)
    assert gates.max() < 4.0
    assert np.isinf(cost[0, 1])
    assert np.isinf(cost[1, 0])


def test_a_person_is_born_between_the_legs_as_old_as_the_younger():
    people = person(offset=(0.1, 0.05))
    assert people["x"][0, :2] == pytest.approx([2.0, 1.0])
    assert people["offset"][0] == pytest.approx([0.1, 0.05])
    assert people["confidence"][0] == pytest.approx(0.8)
    assert people["age_s"][0] == 1.0
    assert np.isinf(people["camera_s"][0])


def test_two_legs_measure_the_centre_and_one_leg_less_its_offset():
    z, d = np.array([[2.1, 1.0], [1.9, 1.0]]), np.array([0.9, 0.5])
    both = person_tracks.measure(person(), np.array([[0, 1]]), z, d)
    assert both.centre[0] == pytest.approx([2.0, 1.0])
    assert not both.one_leg[0]
    first = person_tracks.measure(person(), np.array([[0, -1]]), z, d)
    second = person_tracks.measure(person(), np.array([[-1, 1]]), z, d)
    for seen in (first, second):
        assert seen.one_leg[0]
        assert seen.centre[0] == pytest.approx([2.0, 1.0])
    nothing = person_tracks.measure(person(), np.array([[-1, -1]]), z, d)
    assert not nothing.seen[0]
    assert nothing.confidence[0] == 0.0


def test_one_leg_moves_a_person_less_than_two():
    moved = []
    for one_leg in (False, True):
        people = person()
        sighting = person_tracks.Sightings(
            np.array([True]), np.array([[2.3, 1.0]]), np.array([0.9]), np.array([one_leg])
        )
        person_tracks.correct(people, sighting, 0.1, CONFIG)
        moved.append(people["x"][0, 0] - 2.0)
    assert 0.0 < moved[1] < moved[0] < 0.3
    both, one = (0.05 / (0.05 + r) for r in (MOTION.r, MOTION.r + MOTION.one_leg_variance))
    assert moved == pytest.approx([0.3 * both, 0.3 * one], rel=1e-6)


def test_what_is_believed_of_the_offset_fades():
    people = person()
    person_tracks.predict(people, CONFIG.pairing.offset_s, CONFIG)
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
