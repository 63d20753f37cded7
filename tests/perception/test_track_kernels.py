"""The kernels of the tracker, against plain numpy."""

import numpy as np
import pytest
import tracking_reference as reference
from centres_reference import move_to_centres_reference
from tagalong.perception.legs.centres_kernel import move_to_centres
from tagalong.perception.tracking import track_kernels
from tagalong.perception.tracking.assignment import near_pairs
from tagalong.perception.tracking.tracks import LEG, LEGS, PERSON, begin, no_tracks, take, tracks_of, with_room

SEEDS = pytest.mark.parametrize("seed", range(4))


def tracks(kind, count, rng):
    rows = np.zeros(count, dtype=kind)
    for name in kind.names:
        if name != "id":
            rows[name] = rng.uniform(0.1, 2.0, rows[name].shape)
    return rows


def a_match(count, detections, rng):
    match = np.full(count, -1)
    chosen = rng.permutation(count)[: min(count, detections) - 1]
    match[chosen] = rng.permutation(detections)[: len(chosen)]
    return match


def assert_same(ours, theirs):
    for name in theirs.dtype.names:
        np.testing.assert_array_equal(ours[name], theirs[name])


@SEEDS
@pytest.mark.parametrize("kind", [LEG, PERSON], ids=["legs", "people"])
def test_prediction(seed, kind):
    ours = tracks(kind, 7, np.random.default_rng(seed))
    theirs = ours.copy()
    track_kernels.predict(ours["x"], ours["p"], ours["age_s"], ours["unseen_s"], 0.1, 0.05)
    before = theirs.copy()
    reference.predict(theirs, 0.1, 0.05)
    assert_same(ours, theirs)
    assert all((ours[name] != before[name]).any() for name in ("x", "p", "age_s", "unseen_s"))


@SEEDS
def test_correction_of_legs(seed):
    rng = np.random.default_rng(seed)
    ours, z, d = tracks(LEG, 7, rng), rng.uniform(0, 2, (5, 2)), rng.uniform(0, 1, 5)
    theirs, match = ours.copy(), a_match(7, 5, rng)
    track_kernels.correct_legs(ours, match, z, d, 0.1, 0.05)
    before = theirs.copy()
    reference.correct_legs(theirs, match, z, d, 0.1, 0.05)
    assert_same(ours, theirs)
    assert ((ours["x"] != before["x"]).any(axis=1) == (match >= 0)).all()


@SEEDS
def test_measurement_and_correction_of_people(seed):
    rng = np.random.default_rng(seed)
    ours, z, d = tracks(PERSON, 6, rng), rng.uniform(0, 2, (9, 2)), rng.uniform(0, 1, 9)
    theirs, match = ours.copy(), a_match(12, 9, rng).reshape(6, 2)
    seen, one, centre, confidence = np.zeros(6, bool), np.zeros(6, bool), np.zeros((6, 2)), np.zeros(6)
    track_kernels.measure_people(ours["offset"], match, z, d, seen, one, centre, confidence)
    expected = reference.measure_people(theirs["offset"], match, z, d)
    for got, wanted in zip((seen, one, centre, confidence), expected, strict=True):
        np.testing.assert_array_equal(got, wanted)
    variance = np.where(one, 0.2, 0.1)
    track_kernels.correct_people(ours, seen, centre, confidence, variance, 0.05)
    reference.correct_people(theirs, seen, centre, confidence, variance, 0.05)
    assert_same(ours, theirs)


@SEEDS
def test_costs_of_legs(seed):
    rng = np.random.default_rng(seed)
    legs, centres, z = tracks(LEG, 7, rng), rng.uniform(0, 2, (2, 2)), rng.uniform(0, 2, (5, 2))
    gates, cost = rng.uniform(0.5, 1.5, 7), np.empty((7, 5))
    track_kernels.leg_costs(legs, centres, z, 0.8, 1.0, gates, cost)
    np.testing.assert_allclose(cost, reference.leg_costs(legs, centres, z, 0.8, 1.0, gates), rtol=1e-14)
    np.testing.assert_allclose(
        track_kernels.distances(centres, z), np.hypot(*(centres[:, None] - z).transpose(2, 0, 1)), rtol=1e-14
    )


@SEEDS
def test_means_of_the_vectors_between_tracks(seed):
    rng = np.random.default_rng(seed)
    x, age_s, apart = rng.normal(size=(6, 4)), rng.uniform(0, 2, 6), rng.normal(size=(6, 6, 2))
    expected = reference.average_apart(x[:, :2], age_s, apart, 0.1, 1.0)
    wide = track_kernels.any_wide(apart, np.array([[0, 1], [2, 3]]), 1.5)
    assert wide == (np.linalg.norm(apart[[0, 2], [1, 3]], axis=1) > 1.5).any()
    track_kernels.average_apart(x, age_s, apart, 0.1, 1.0)
    np.testing.assert_allclose(apart, expected, rtol=1e-14)


@SEEDS
def test_tracks_that_begin_and_those_that_are_taken_keep_their_means(seed):
    rng = np.random.default_rng(seed)
    many = tracks_of(with_room(no_tracks(1, 12), 20), 0)
    begin(many, rng.normal(size=(6, 2)), np.ones(6), 0.05)
    many.apart[:6, :6] = rng.normal(size=(6, 6, 2))
    before, z = many.apart[:6, :6].copy(), rng.normal(size=(2, 2))
    begin(many, z, np.ones(2), 0.05)
    grown = reference.with_fresh(before, many.legs["x"][:8, :2])
    np.testing.assert_array_equal(many.apart[:8, :8], grown)
    np.testing.assert_array_equal(many.legs["high"][6:8], z)
    legs, order = many.legs[:8].copy(), np.array([4, 0, 7])
    take(many, order)
    assert many.counts[LEGS] == 3
    np.testing.assert_array_equal(many.apart[:3, :3], grown[np.ix_(order, order)])
    np.testing.assert_array_equal(many.legs[:3], legs[order])


@SEEDS
def test_points_of_things_far_from_humans(seed):
    rng = np.random.default_rng(seed)
    points, humans = rng.uniform(0, 4, (60, 2)), rng.uniform(0, 4, (4, 2))
    start, end, thing = np.array([3, 20, 41]), np.array([15, 40, 60]), np.array([True, False, True])
    for people in (humans, humans[:0]):
        arguments = points, start, end, thing, people, 0.7
        np.testing.assert_array_equal(
            track_kernels.points_of_things(*arguments), reference.points_of_things(*arguments)
        )


@SEEDS
def test_pairs_nearer_than_their_limit(seed):
    rng = np.random.default_rng(seed)
    cost, limit = rng.uniform(0, 1, (5, 4)), rng.uniform(0, 0.5, 5)
    near = cost < limit[:, None]
    rows, columns, alone = near_pairs(cost, limit)
    assert alone == (near.sum(axis=0).max() <= 1 and near.sum(axis=1).max() <= 1)
    np.testing.assert_array_equal(rows, np.flatnonzero(near.any(axis=1)))
    np.testing.assert_array_equal(np.sort(columns), np.flatnonzero(near.any(axis=0)))
    assert not alone or near[rows, columns].all()


@SEEDS
def test_whether_any_leg_moved(seed):
    legs = tracks(LEG, 5, np.random.default_rng(seed))
    size = np.hypot(*(legs["high"] - legs["low"]).T)
    able = (legs["confidence"] > 0.5) & (legs["unseen_s"] <= 1.5) & (np.arange(5) >= 2)
    assert track_kernels.any_moved(legs, 2, 0.6, 0.5, 1.5) == (able & (size >= 0.6)).any()


@SEEDS
def test_who_survives_and_who_walks_surely(seed):
    legs = tracks(LEG, 6, np.random.default_rng(seed))
    legs["unseen_s"][::2] = 0.0
    size = np.hypot(*(legs["high"] - legs["low"]).T)
    sure = (legs["unseen_s"] == 0.0) & (legs["age_s"] >= 0.5) & (legs["confidence"] >= 0.8) & (size >= 0.6)
    assert track_kernels.any_sure_walker(legs, 1, 0.6, 0.8, 0.5) == sure[1:].any()
    lives = (legs["p"][:, 0] <= 1.0) & (legs["confidence"] >= 0.7)
    np.testing.assert_array_equal(track_kernels.surviving(legs, 1.0, 0.7), lives)


@SEEDS
def test_spread_among_some_tracks(seed):
    rng = np.random.default_rng(seed)
    x, apart, rows = rng.normal(size=(6, 4)), rng.normal(size=(6, 6, 2)), np.array([0, 2, 3, 5])
    expected = np.linalg.norm(apart, axis=2)
    expected[np.hypot(*(x[:, None, :2] - x[:, :2]).transpose(2, 0, 1)) > 1.2] = np.inf
    np.fill_diagonal(expected, np.inf)
    np.testing.assert_allclose(track_kernels.spread_among(apart, x, rows, 1.2), expected[np.ix_(rows, rows)])


@SEEDS
def test_centres_of_legs(seed):
    rng = np.random.default_rng(seed)
    points, start, end = rng.normal(size=(30, 2)), np.array([0, 8, 20]), np.array([5, 20, 30])
    ours, theirs = np.empty((3, 2)), np.empty((3, 2))
    move_to_centres(points, start, end, 0.16, 0.4, ours)
    move_to_centres_reference(points, start, end, 0.16, 0.4, theirs)
    np.testing.assert_allclose(ours, theirs, rtol=1e-14)
