"""Clustering the points of a scan into objects."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from landmarks_reference import heuristic_labels_reference, round_centres_reference
from sklearn.cluster import DBSCAN
from sklearn.metrics import adjusted_rand_score
from tagalong.slam.errors import InputError
from tagalong.slam.landmarks.clustering import METHODS, Dbscan, make_clusterer
from tagalong.slam.landmarks.heuristic_kernel import heuristic_labels
from tagalong.slam.landmarks.objects import (
    SightingConfig,
    covariance_ellipse,
    describe_objects,
    see_landmarks,
)
from tagalong.slam.landmarks.round_centres import round_centres
from tagalong.slam.scan import LaserScan

CENTRES = np.array([(2.0, 0.0), (0.0, 3.0), (-3.0, -2.0), (4.0, 4.0)])


def blobs(rng, each=12):
    """Return four well separated groups of points, and which is which."""
    return np.repeat(CENTRES, each, axis=0) + 0.03 * rng.standard_normal((4 * each, 2)), np.repeat(np.arange(4), each)


@pytest.mark.parametrize(
    ("name", "settings"),
    [
        ("heuristic", {}),
        ("dbscan", {}),
        ("kmeans", {"choice": "elbow"}),
        ("kmeans", {"choice": "silhouette"}),
        ("gmm", {"choice": "bic"}),
    ],
)
def test_each_method_finds_objects_that_stand_apart(name, settings):
    points, truth = blobs(np.random.default_rng(0))
    assert adjusted_rand_score(truth, make_clusterer(name, **settings).fit_predict(points)) == 1.0


@pytest.mark.parametrize("name", METHODS)
def test_no_points_one_point_and_equal_points_are_no_error(name):
    clusterer = make_clusterer(name)
    assert clusterer.fit_predict(np.zeros((0, 2))).shape == (0,)
    assert clusterer.fit_predict([[1.0, 2.0]]).tolist() == [0]
    assert clusterer.fit_predict(np.ones((7, 2))).tolist() == [0] * 7


@given(seed=st.integers(0, 999), count=st.integers(1, 60), min_points=st.integers(1, 6), epsilon=st.floats(0.05, 1.0))
def test_dbscan_labels_as_scikit_learn_does(seed, count, min_points, epsilon):
    points = np.random.default_rng(seed).uniform(0.0, 2.0, (count, 2))
    ours = Dbscan(epsilon=epsilon, min_points=min_points).fit_predict(points)
    assert ours.tolist() == DBSCAN(eps=epsilon, min_samples=min_points).fit_predict(points).tolist()


@given(st.integers(0, 999), st.integers(0, 40), st.integers(1, 4), st.sampled_from([0.1, 0.5, 2.0]))
def test_the_compiled_heuristic_equals_numpy(seed, count, min_points, distance):
    points = np.cumsum(np.random.default_rng(seed).normal(0.0, 0.4, (count, 2)), axis=0)
    found = heuristic_labels(points, distance, min_points)
    np.testing.assert_array_equal(found, heuristic_labels_reference(points, distance, min_points))
    assert found.shape == (count,)


def test_mean_covariance_and_ellipse_are_those_of_the_points():
    rng = np.random.default_rng(1)
    points = rng.standard_normal((4000, 2)) * (0.4, 0.1) @ np.array([[0.8, 0.6], [-0.6, 0.8]]) + (5.0, 1.0)
    objects = describe_objects(points, np.zeros(4000, dtype=np.int64))
    np.testing.assert_allclose(objects.means[0], points.mean(axis=0))
    np.testing.assert_allclose(objects.covariances[0], np.cov(points.T, bias=True))
    ellipse = covariance_ellipse(objects.means[0], objects.covariances[0], sigmas=1.0)
    np.testing.assert_allclose(ellipse.semi_axes, (0.4, 0.1), rtol=0.05)
    assert ellipse.angle % np.pi == pytest.approx(np.arctan2(0.6, 0.8), abs=0.02)
    assert ellipse.area == pytest.approx(np.pi * 0.04, rel=0.1)


def test_a_round_post_is_seen_at_its_centre():
    bearings = np.linspace(-np.pi / 2, np.pi / 2, 1801)
    along, beside = 3.0 * np.cos(bearings), 9.0 * np.sin(bearings) ** 2
    ranges = np.where(beside < 0.01, along - np.sqrt(np.maximum(0.01 - beside, 0.0)), np.inf)
    scan = LaserScan(ranges, bearings, 0.1, 8.0)
    seen = see_landmarks(scan, Dbscan(), SightingConfig(radius=0.1))
    np.testing.assert_allclose(seen.z, [[3.0, 0.0]], atol=0.005)


def post_seen(distance, bearing, rng, sigma=0.01, radius=0.1):
    """Return the sighting of one post by beams a degree apart, its R, and the error of its range and bearing."""
    bearings = np.linspace(-np.pi / 2, np.pi / 2, 181)
    along, beside = distance * np.cos(bearings - bearing), distance * np.sin(bearings - bearing)
    ranges = along - np.sqrt(np.maximum(radius**2 - beside**2, 0.0)) + sigma * rng.standard_normal(181)
    scan = LaserScan(np.where(np.abs(beside) < radius, ranges, np.inf), bearings, 0.1, 8.0)
    return see_landmarks(scan, Dbscan(), SightingConfig(radius=radius, sigma_range=sigma))


@pytest.mark.parametrize("distance", [1.0, 2.0, 4.0, 5.5, 7.0])
def test_centres_are_unbiased_and_their_covariance_is_that_of_their_errors(distance):
    rng, errors, nis = np.random.default_rng(1), [], []
    for _ in range(400):
        truth = np.array([distance + rng.uniform(-0.2, 0.2), rng.uniform(-1.2, 1.2)])
        seen = post_seen(*truth, rng)
        errors.append(seen.z[0] - truth)
        nis.append(errors[-1] @ np.linalg.solve(seen.R[0], errors[-1]))
    spread = np.std(errors, axis=0)
    assert (np.abs(np.mean(errors, axis=0)) < 4.0 * spread / np.sqrt(400.0)).all()
    assert (spread < (0.012, 0.0025)).all()
    assert 1.6 < np.mean(nis) < 2.4


@given(seed=st.integers(0, 999), radius=st.floats(0.03, 0.4))
def test_the_compiled_centres_are_those_of_the_arrays(seed, radius):
    rng = np.random.default_rng(seed)
    label = np.sort(np.concatenate((np.arange(4), rng.integers(0, 4, 20))))
    bearings = 0.4 * label + 0.0175 * rng.permutation(len(label)) / 4.0
    ranges = 2.0 + label + 0.02 * rng.standard_normal(len(label))
    arguments = ranges, bearings, label.astype(np.int64), 0.0175, radius, 0.01
    for ours, reference in zip(round_centres(*arguments), round_centres_reference(*arguments), strict=True):
        np.testing.assert_allclose(ours, reference, rtol=1e-7, atol=1e-12)


def test_a_laser_that_is_mounted_askew_sees_the_same_post():
    bearings = np.linspace(-np.pi / 2, np.pi / 2, 1801)
    ranges = 3.0 * np.cos(bearings) - np.sqrt(np.maximum(0.01 - 9.0 * np.sin(bearings) ** 2, 0.0))
    ranges = np.where(np.abs(3.0 * np.sin(bearings)) < 0.1, ranges, np.inf)
    scan = LaserScan(ranges, bearings, 0.1, 8.0, 0.0, (0.2, 0.1, 0.5))
    seen = see_landmarks(scan, Dbscan(), SightingConfig(sigma_shape=0.02))
    x, y = 0.2 + 3.0 * np.cos(0.5), 0.1 + 3.0 * np.sin(0.5)
    np.testing.assert_allclose(seen.z, [[np.hypot(x, y), np.arctan2(y, x)]], atol=0.005)
    assert np.linalg.eigvalsh(seen.R[0])[0] > 0.0
    assert seen.R[0, 0, 0] > 0.02**2


def test_objects_that_are_cut_by_a_nearer_one_or_by_the_edge_are_no_landmarks():
    bearings = np.linspace(-1.0, 1.0, 21)
    ranges = np.full(21, np.inf)
    ranges[[0, 6, 12]] = 3.0, 3.0, 5.0
    ranges[13] = 2.0
    seen = see_landmarks(LaserScan(ranges, bearings, 0.1, 8.0), Dbscan(), SightingConfig())
    assert sorted(seen.z[:, 1].round(3).tolist()) == [round(bearings[6], 3), round(bearings[13], 3)]


def test_wrong_settings_are_named():
    with pytest.raises(InputError, match="unknown clustering method 'optics'"):
        make_clusterer("optics")
    with pytest.raises(InputError, match="min_points"):
        make_clusterer("dbscan", min_points=0)
    with pytest.raises(InputError, match="finite"):
        Dbscan().fit_predict([[np.inf, 0.0]])
