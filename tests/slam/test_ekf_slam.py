"""EKF-SLAM: right derivatives, honest covariance, short memory of being lost."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from landmark_worlds import BEARINGS, cast, circle_path, draw_posts, typical_wheels
from scipy.stats import chi2
from tagalong.slam.ekf.association import compare, joint_compatibility, nearest_neighbour
from tagalong.slam.ekf.calibrated_motion import advance, advance_jacobian
from tagalong.slam.ekf.engine import EkfSlam
from tagalong.slam.ekf.localization import ObjectLocalizer
from tagalong.slam.ekf.models import (
    locate,
    locate_jacobians,
    measure,
    measure_jacobian,
    unicycle,
    unicycle_jacobian,
)
from tagalong.slam.engine import make_slam
from tagalong.slam.errors import InputError
from tagalong.slam.geometry import between, wrap_angle
from tagalong.slam.scan import LaserScan
from threadpoolctl import threadpool_info

number = st.floats(-5.0, 5.0)


def numerical(function, x):
    """Return the derivative of `function` (m,) at x (n,) by central differences."""
    columns = []
    for step in 1e-6 * np.eye(len(x)):
        columns.append((function(x + step) - function(x - step)) / 2e-6)
    return np.stack(columns, axis=-1)


@settings(deadline=None)
@given(st.tuples(number, number, st.floats(-1.0, 1.0)), number, st.floats(0.3, 4.0), st.floats(0.3, 4.0))
def test_every_jacobian_equals_the_numerical_one(pose, v, dx, dy):
    pose = np.array(pose)
    place = pose[:2] + np.array([dx, dy])
    np.testing.assert_allclose(
        unicycle_jacobian(pose, v, 0.1), numerical(lambda x: unicycle(x, v, 0.2, 0.1), pose), atol=1e-6
    )
    H = measure_jacobian(pose, place[None])[0]
    np.testing.assert_allclose(H, numerical(lambda x: measure(x, place[None])[0], pose), atol=1e-6)
    np.testing.assert_allclose(-H[:, :2], numerical(lambda p: measure(pose, p[None])[0], place), atol=1e-6)
    z = np.array([dx, dy - 2.0])
    by_pose, by_z = locate_jacobians(pose, z)
    np.testing.assert_allclose(by_pose, numerical(lambda x: locate(x, z), pose), atol=1e-6)
    np.testing.assert_allclose(by_z, numerical(lambda s: locate(pose, s), z), atol=1e-6)
    state, reported = np.concatenate((pose, (0.02, -0.03, 0.01))), np.array([0.1 * dx, 0.05, 0.1 * v])
    np.testing.assert_allclose(
        advance_jacobian(state, reported), numerical(lambda x: advance(x, reported)[:3], state), atol=1e-6
    )


def drive(seed, blind=(0, 0), **options):
    """Return the engine, its squared errors by covariance (n,) and position errors (n,) round a circle of 68 m."""
    rng = np.random.default_rng(seed)
    path = circle_path()
    posts, odometry, truth = draw_posts(rng, 24, path), typical_wheels(path, rng), between(path[0], path)
    engine, nees, errors = make_slam("ekf", **options), [], []
    for i, pose in enumerate(path):
        engine.update(odometry[i], cast(pose, posts if not blind[0] <= i < blind[1] else posts[:0], rng))
        error = engine.pose - truth[i]
        error[2] = wrap_angle(error[2])
        nees.append(error @ np.linalg.solve(engine.filter.P[:3, :3], error))
        errors.append(np.hypot(error[0], error[1]))
    return engine, np.array(nees), np.array(errors)


def test_the_path_is_right_and_the_covariance_says_how_right():
    runs = [drive(seed) for seed in range(4)]
    assert np.mean([np.sqrt((errors**2).mean()) for *_, errors in runs]) < 0.05
    average = np.mean([nees for _, nees, _ in runs], axis=0)[5:]
    low, high = chi2.ppf([0.025, 0.975], 3 * len(runs)) / len(runs)
    assert ((average > low) & (average < high)).mean() >= 0.8
    assert all(len(engine.times_seen) >= 20 for engine, *_ in runs)


def test_a_post_is_not_learned_twice():
    engine, rng = make_slam("ekf", travel=0.0), np.random.default_rng(0)
    posts = np.array([(3.0, 1.0), (4.0, -2.0), (2.0, 0.0)])
    moved = np.array([(3.0, 1.0), (4.0, -2.0), (2.0, 0.15)])
    for _ in range(50):
        engine.update(np.zeros(3), cast(np.zeros(3), posts, rng))
    engine.update(np.zeros(3), cast(np.zeros(3), moved, rng))
    assert len(engine.times_seen) == 3


@pytest.mark.parametrize("association", ["joint", "nearest"])
def test_after_six_metres_without_landmarks_it_is_back_within_three(association):
    for seed in range(2):
        _, _, errors = drive(seed, blind=(400, 460), association=association)
        assert errors[460:490].min() < 0.1
        assert (errors[490:] < 0.1).mean() > 0.95


def test_joint_compatibility_sees_what_nearest_neighbour_cannot():
    places = np.array([[2.0, 0.0], [2.0, 0.5], [2.0, 1.0]])
    common = np.kron(np.ones((3, 3)), np.diag([1e-4, 0.09]))
    z = places[1:] + (0.0, -0.5) + 1e-3
    R = np.tile(1e-4 * np.eye(2), (2, 1, 1))
    pairs = compare(z + np.array([0.0, 0.02]), R, places, common)
    assert joint_compatibility(pairs, 9.21) == [(0, 0), (1, 1)]
    assert len(nearest_neighbour(pairs, 9.21)) == 2


def test_two_pairs_that_no_one_pose_explains_are_not_both_taken_though_each_is_the_only_one():
    # one error of the pose moves both landmarks alike in range; the two innovations oppose each other
    expected = np.array([[3.0, -1.0], [3.0, 1.0]])
    z, R = expected + np.array([[0.25, 0.0], [-0.25, 0.0]]), np.tile(np.diag([0.01**2, 0.01**2]), (2, 1, 1))
    together = np.kron(np.ones((2, 2)), np.diag([0.1**2, 0.0]))
    apart = np.kron(np.eye(2), np.diag([0.1**2, 0.0]))
    assert len(nearest_neighbour(compare(z, R, expected, together), 9.21)) == 2
    assert len(joint_compatibility(compare(z, R, expected, together), 9.21)) == 1
    assert joint_compatibility(compare(z, R, expected, apart), 9.21) == [(0, 0), (1, 1)]


def test_localization_on_a_known_map_follows_the_robot():
    rng = np.random.default_rng(3)
    objects = rng.uniform(-8.0, 8.0, (20, 2))
    truth = np.zeros(3)
    localizer = ObjectLocalizer(objects, [0.1, -0.1, 0.02])
    for _ in range(100):
        truth = unicycle(truth, 0.5, 0.2, 0.1)
        localizer.predict(0.5 * 1.02, 0.2 * 1.02, 0.1)
        seen = measure(truth, objects)[:6] + rng.standard_normal((6, 2)) * (0.02, 0.005)
        localizer.update(seen, np.tile(np.diag([4e-4, 2.5e-5]), (6, 1, 1)))
    assert np.hypot(*(localizer.filter.x - truth)[:2]) < 0.03
    assert localizer.update(np.array([[100.0, 0.0]]), np.diag([4e-4, 2.5e-5])[None]) == 0


RANGES = np.array([np.inf, np.nan, 0.0, 1e-3, 0.5, 2.0, 2.0, 2.01, 7.9, 1e9])
"""What a broken laser may say [m]."""


@settings(max_examples=30, deadline=None)
@given(
    seed=st.integers(0, 10**6),
    leaps=st.lists(st.tuples(st.floats(-2.0, 2.0), st.floats(-2.0, 2.0), st.floats(-4.0, 4.0)), min_size=1, max_size=6),
    empty=st.floats(0.0, 1.0),
    widest=st.sampled_from([0.25, 50.0]),
)
def test_nothing_breaks_symmetry_or_positive_definiteness(seed, leaps, empty, widest):
    engine, rng = make_slam("ekf", travel=0.0, turn=0.0, widest=widest), np.random.default_rng(seed)
    drawn = [np.where(rng.random(181) < empty, np.inf, rng.choice(RANGES, 181)) for _ in leaps]
    ranges = [np.full(181, np.inf), *drawn, drawn[-1], np.full(181, 2.0)]
    for odometry, sweep in zip([np.zeros(3), *leaps, leaps[-1], leaps[-1]], ranges, strict=True):
        engine.update(odometry, LaserScan(sweep, BEARINGS, 0.1, 8.0))
        P = engine.filter.P
        assert np.array_equal(P, P.T)
        assert np.linalg.eigvalsh(P)[0] > 0.0
        assert np.isfinite(engine.filter.x).all()


def test_duplicate_landmarks_keep_the_filter_sound():
    engine = make_slam("ekf")
    engine.update(np.zeros(3), cast(np.zeros(3), np.zeros((0, 2)), np.random.default_rng(0)))
    for _ in range(4):
        engine.filter.add(np.array([3.0, 0.1]), np.diag([1e-4, 1e-5]))
    for i in range(30):
        chosen = np.array([i % 4, (i + 1) % 4])
        expected, H, states = engine.filter.expect(chosen)
        engine.filter.correct((np.array([[3.0, 0.1]]) - expected).ravel(), 1e-5 * np.eye(4), H, states)
        assert np.array_equal(engine.filter.P, engine.filter.P.T)
        assert np.linalg.eigvalsh(engine.filter.P)[0] > 0.0


def test_a_post_that_was_never_there_is_forgotten():
    engine = make_slam("ekf", travel=0.0)
    rng = np.random.default_rng(0)
    there = np.array([(3.0, 1.0), (4.0, -2.0)])
    engine.update(np.zeros(3), cast(np.zeros(3), np.vstack((there, [(2.0, 0.0)])), rng, sigma=0.001))
    behind = np.vstack((there, [(5.0, 0.0)]))
    for _ in range(5):
        engine.update(np.zeros(3), cast(np.zeros(3), behind, rng, sigma=0.001))
    assert len(engine.times_seen) == 3
    assert (np.hypot(*(engine.filter.landmarks - (2.0, 0.0)).T) > 0.5).all()


@pytest.mark.parametrize("first", [-np.pi, 0.0])
def test_a_post_that_was_never_there_is_forgotten_wherever_the_sweep_begins(first):
    bearings = first + np.radians(np.arange(0.5, 360.0))
    engine, posts = make_slam("ekf", travel=0.0), np.array([[2.0, 1.0], [2.0, -1.0]])
    engine.update(np.zeros(3), cast(np.zeros(3), posts, np.random.default_rng(0), bearings=bearings))
    assert len(engine.filter.landmarks) == 2
    for _ in range(engine.config.patience):
        engine.update(np.zeros(3), LaserScan(np.full(360, np.inf), bearings, 0.1, 8.0))
    assert len(engine.filter.landmarks) == 0


def test_a_scan_without_beams_changes_nothing():
    engine = make_slam("ekf")
    for x in (0.0, 1.0):
        engine.update((x, 0.0, 0.0), LaserScan(np.zeros(0), np.zeros(0), 0.05, 6.0))
    np.testing.assert_allclose(engine.pose, (1.0, 0.0, 0.0))


def test_it_keeps_the_protocol_of_engines():
    engine, _, _ = drive(0)
    first, again = engine.trajectory(), drive(0)[0].trajectory()
    assert first.shape == (len(circle_path()), 3)
    np.testing.assert_array_equal(first, again)
    assert engine.map().occupied.any()
    assert engine.map_at(0.1).resolution == 0.1
    with pytest.raises(InputError, match="clustering method"):
        make_slam("ekf", clustering="optics")
    with pytest.raises(InputError, match="odometry"):
        engine.update([np.nan, 0.0, 0.0], cast(np.zeros(3), np.zeros((0, 2)), np.random.default_rng(0)))


def test_the_filter_multiplies_in_one_thread_and_leaves_the_others_as_they_were(monkeypatch):
    threads = lambda: [pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"]  # noqa: E731
    before, inside = threads(), []
    take = EkfSlam.take
    monkeypatch.setattr(EkfSlam, "take", lambda self, *given: (inside.extend(threads()), take(self, *given))[1])
    drive(0)
    assert set(inside) == {1}
    assert threads() == before
