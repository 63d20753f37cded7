import numpy as np
import pytest
from pairing_reference import better_pairs_reference, mutual_pairs_reference
from tagalong.perception.tracking.config import TrackerConfig
from tagalong.perception.tracking.numbers import numbers_of
from tagalong.perception.tracking.pairing import better_pairs, mutual_pairs
from tagalong.perception.tracking.reidentification import number, predict_lost
from tagalong.perception.tracking.tracks import LOST, PERSON, no_tracks, tracks_of


def spread_of(places):
    places = np.asarray(places, dtype=float)
    spread = np.abs(places[:, None] - places)
    np.fill_diagonal(spread, np.inf)
    return spread


@pytest.mark.parametrize("seed", range(20))
def test_the_kernels_do_what_plain_numpy_does(seed):
    rng = np.random.default_rng(seed)
    spread = spread_of(np.round(rng.uniform(0.0, 2.0, 11), 1))  # rounded: there are ties
    np.testing.assert_array_equal(mutual_pairs(spread, 0.5), mutual_pairs_reference(spread, 0.5))
    arguments = spread, rng.permutation(8).reshape(4, 2), rng.integers(0, 4, 11) / 2.0, np.array([8, 9, 10]), 0.15
    np.testing.assert_array_equal(better_pairs(*arguments), better_pairs_reference(*arguments))


def test_a_leg_waits_for_its_partner_rather_than_take_a_strangers():
    spread = spread_of([0.0, 0.2, 0.6, 0.8])  # two people side by side
    assert mutual_pairs(spread, 0.5).tolist() == [[0, 1], [2, 3]]
    assert mutual_pairs(spread_of([0.0, 0.2, 0.3]), 0.5).tolist() == [[1, 2]]
    assert mutual_pairs(spread, 0.1).tolist() == []


def test_people_who_took_each_others_legs_exchange_them():
    spread = spread_of([0.0, 0.2, 0.8, 1.0])
    pairs = better_pairs(spread, np.array([[0, 2], [1, 3]]), np.ones(4), np.zeros(0, dtype=int), 0.15)
    assert sorted(sorted(pair) for pair in pairs.tolist()) == [[0, 1], [2, 3]]


def test_a_person_gives_its_newer_leg_for_a_nearer_one():
    spread = spread_of([0.0, 0.7, 0.2])
    pairs = better_pairs(spread, np.array([[0, 1]]), np.array([5.0, 1.0, 0.0]), np.array([2]), 0.15)
    assert pairs.tolist() == [[0, 2]]
    kept = better_pairs(spread_of([0.0, 0.7, 0.6]), np.array([[0, 1]]), np.array([5.0, 1.0, 0.0]), np.array([2]), 0.15)
    assert kept.tolist() == [[0, 1]]


def lost_person(config, seconds):
    tracks = tracks_of(no_tracks(1), 0)
    person = tracks.lost[:1]
    person["id"], person["x"], person["p"], person["unseen_s"] = 7, (1.0, 0.0, 0.5, 0.0), (0.05, 0.0, 0.05), 0.5
    tracks.counts[LOST], tracks.counts[3] = 1, 8
    for _ in range(round(10 * seconds)):
        predict_lost(tracks, 0.1, numbers_of(config))
    return tracks


def numbered(tracks, place, age_s, config):
    fresh = np.zeros(1, dtype=PERSON)
    fresh["x"][0, :2], fresh["age_s"] = place, age_s
    number(tracks, fresh, numbers_of(config))
    return int(fresh["id"][0])


def test_a_lost_person_is_met_again_where_it_went_but_not_elsewhere_nor_if_it_was_there_before():
    config, near, far = TrackerConfig(), (1.6, 0.1), (6.0, 0.0)
    assert numbered(lost_person(config, 2.0), near, 1.0, config) == 7
    assert numbered(lost_person(config, 2.0), far, 1.0, config) == 8
    assert numbered(lost_person(config, 2.0), near, 9.0, config) == 8
    assert numbered(lost_person(config, config.reidentification.max_age_s), near, 1.0, config) == 8
    tracks = lost_person(config, 2.0)
    numbered(tracks, near, 1.0, config)
    assert numbered(tracks, near, 1.0, config) == 8  # met once, lost no more
