"""Motion model, resampling and paths: statistics with known answers."""

from dataclasses import replace

import numpy as np
import pytest
from tagalong.slam.geometry import between, compose
from tagalong.slam.gmapping import alignment
from tagalong.slam.gmapping.alignment import Candidate
from tagalong.slam.gmapping.config import GMappingConfig, MatcherConfig, TrackingConfig
from tagalong.slam.gmapping.engine import GMapping
from tagalong.slam.gmapping.matcher import Matches, ParticleScanMatcher
from tagalong.slam.gmapping.motion import MotionModel
from tagalong.slam.gmapping.paths import PathTree
from tagalong.slam.gmapping.resampling import effective_number, normalised, systematic
from tagalong.slam.gmapping.tile_maps import TileMaps
from tagalong.slam.gmapping.tracking import Tracker
from tagalong.slam.processes.threads import Workers
from tagalong.slam.scan import LaserScan

INCREMENTS = np.array([[0.1, 0.0, 0.05], [0.1, 0.01, 0.05], [0.05, -0.02, -0.1], [0.2, 0.0, 0.2]])


def test_the_covariance_of_gathered_odometry_is_that_of_sampled_drives():
    rng = np.random.default_rng(0)
    model = MotionModel(0.1, 0.1, 0.05, 0.1)
    drives = rng.standard_normal((100_000, 3)) * np.sqrt(np.diag(model.covariance))
    errors = rng.standard_normal(drives.shape)  # of one sign all the way
    for increment in INCREMENTS:
        model.add(increment)
        drives = compose(drives, increment + errors * model.deviations(increment))
    np.testing.assert_allclose(drives.mean(axis=0), model.mean, atol=4e-3)
    np.testing.assert_allclose(np.cov(drives.T), model.covariance, rtol=0.05, atol=2e-5)
    assert model.travelled == pytest.approx(np.hypot(*INCREMENTS[:, :2].T).sum())
    assert model.turned == pytest.approx(0.4)
    model.reset()
    assert not model.mean.any()
    assert model.covariance.max() < 1e-4


def test_the_covariance_does_not_depend_on_how_often_odometry_is_read():
    coarse, fine = MotionModel(0.1, 0.1, 0.05, 0.1), MotionModel(0.1, 0.1, 0.05, 0.1)
    coarse.add(np.array([0.5, 0.0, 0.0]))
    for _ in range(20):
        fine.add(np.array([0.025, 0.0, 0.0]))
    np.testing.assert_allclose(np.diag(fine.covariance)[[0, 2]], np.diag(coarse.covariance)[[0, 2]], rtol=1e-9)


def test_deviations_follow_the_four_parameters():
    model = MotionModel(0.1, 0.2, 0.3, 0.4)
    np.testing.assert_allclose(model.deviations(np.array([2.0, 0.0, 0.0])), [0.2, 0.06, 0.4])
    np.testing.assert_allclose(model.deviations(np.array([0.0, 0.0, -1.0])), [0.3, 0.3, 0.4])


def drive_with(factor, steps, informative=1e-6, seed=0):
    """A model that has been told of `steps` matched scans by an odometry with `factor` of the errors it expects."""
    rng, model = np.random.default_rng(seed), MotionModel(0.1, 0.2, 0.1, 0.2)
    for _ in range(steps):
        model.reset()
        model.add(np.array([0.5, 0.0, 0.1]))
        prior = model.covariance_at(model.mean)
        truth = model.mean + factor * model.deviations(np.array([0.5, 0.0, 0.1])) * rng.standard_normal(3)
        prior = model.covariance_at(truth)
        noise = np.eye(3) * informative
        gain = prior @ np.linalg.inv(prior + noise)
        told = truth + np.sqrt(informative) * rng.standard_normal(3)
        model.learn(model.mean + gain @ (told - model.mean), prior, prior - gain @ prior)
    return model


@pytest.mark.parametrize("seed", range(3))
def test_the_errors_of_an_odometry_are_learned_where_scans_tell_of_them(seed):
    good, as_expected = (drive_with(factor, 200, seed=seed).scale for factor in (0.2, 1.0))
    assert (good < 0.45).all()
    assert (as_expected > 0.6).all()
    np.testing.assert_allclose(drive_with(0.2, 200, informative=1e6, seed=seed).scale, 1.0, atol=0.05)


def test_one_jump_of_an_odometry_widens_its_own_step_and_hardly_the_next():
    model = drive_with(0.2, 200)
    before = model.scale.copy()
    model.reset()
    model.add(np.array([0.5, 0.0, 0.0]))
    far = model.mean + np.array([0.0, 1.0, 0.0])
    wide = model.covariance_at(far)
    off = far - model.mean
    assert off @ np.linalg.inv(wide) @ off == pytest.approx(3.0)
    np.testing.assert_array_equal(model.covariance_at(model.mean), model.covariance)
    model.learn(far, wide, 1e-6 * np.eye(3))
    assert (model.scale < 1.3 * before).all()


def test_a_jump_of_a_whole_turn_is_none():
    model = MotionModel(0.1, 0.2, 0.1, 0.2)
    model.add(np.array([0.5, 0.0, 3.1]))
    np.testing.assert_allclose(model.covariance_at(model.mean - [0.0, 0.0, 2.0 * np.pi]), model.covariance)


def test_errors_keep_their_sign_over_the_way_to_the_next_matched_scan_and_no_longer():
    def deviation(metres, **spans):
        model = MotionModel(0.1, 0.0, 0.0, 0.0, **spans)
        for _ in range(10 * metres):
            model.add(np.array([0.1, 0.0, 0.0]))
        return np.sqrt(model.covariance[0, 0])

    assert deviation(50) == pytest.approx(5.0, rel=1e-3)
    assert deviation(50, way=0.5) == pytest.approx(0.05 * np.sqrt(100), rel=0.1)
    assert deviation(50, way=0.5, turn=0.3) == deviation(50, way=0.5)


def test_systematic_resampling_is_unbiased_and_never_off_by_one():
    weights = normalised(np.log([0.05, 0.37, 0.13, 0.26, 0.19]))
    draws = [np.bincount(systematic(weights, u), minlength=5) for u in np.linspace(0.0, 1.0, 2000, endpoint=False)]
    np.testing.assert_allclose(np.mean(draws, axis=0), 5 * weights, atol=5e-3)
    assert np.abs(np.array(draws) - 5 * weights).max() < 1.0


def test_the_effective_number_counts_equal_weights_and_ignores_scale():
    assert effective_number(normalised(np.full(8, -1234.5))) == pytest.approx(8.0)
    assert effective_number(normalised(np.array([0.0, -800.0, -900.0]))) == pytest.approx(1.0)


def test_a_path_leads_through_resampled_ancestors():
    tree = PathTree()
    tree.append(np.array([[0.0, 0, 0], [1.0, 0, 0], [2.0, 0, 0]]))
    tree.resample(np.array([2, 2, 0]))
    tree.append(np.array([[10.0, 0, 0], [11.0, 0, 0], [12.0, 0, 0]]))
    tree.append(np.array([[20.0, 0, 0], [21.0, 0, 0], [22.0, 0, 0]]))
    np.testing.assert_array_equal(tree.path(1)[:, 0], [2.0, 11.0, 21.0])
    np.testing.assert_array_equal(tree.path(2)[:, 0], [0.0, 12.0, 22.0])
    np.testing.assert_allclose(between(tree.path(0)[0], tree.path(0)[1]), [8.0, 0.0, 0.0])


@pytest.mark.parametrize(
    ("believed", "value", "against", "located"),
    [
        (False, -2.9, 0.0, True),
        (False, -3.1, 0.0, False),  # found without the odometry, and explained badly
        (True, -3.1, 0.0, True),
        (True, 0.0, 0.39, True),
        (True, 0.0, 0.41, False),
    ],
)
def test_where_the_robot_is_stays_open_by_bounds_of_its_own(monkeypatch, believed, value, against, located):
    config, workers = TrackingConfig(lost=0.4, misfit=3.0), Workers(1)
    tracker = Tracker(config, ParticleScanMatcher(MatcherConfig(), workers), MotionModel(0.1, 0.2, 0.1, 0.2), 0.0)
    found = Candidate(np.zeros(3), 1e-4 * np.eye(3), value, against, 0.0, 0.0)
    monkeypatch.setattr(tracker, "_found", lambda *_: (found, believed))
    tracker.track(TileMaps(1, 0.05, 0.1, workers), 0, np.zeros(3), np.ones((5, 2)), np.array([0.1, 0.0, 0.0]), 0.1)
    assert tracker.located is located


def test_a_sudden_turn_is_believed_where_the_scan_tells_nothing_about_it():
    workers = Workers(1)
    tracker = Tracker(
        TrackingConfig(), ParticleScanMatcher(MatcherConfig(), workers), MotionModel(0.1, 0.2, 0.1, 0.2), 0
    )
    maps, points = TileMaps(1, 0.05, 0.1, workers), np.array([[2.0, 0.0], [2.0, 0.1], [2.0, 0.2]])  # nothing is known
    for k in range(10):
        tracker.track(maps, 0, np.zeros(3), points, np.zeros(3), 0.2 * k)
    tracked = tracker.track(maps, 0, np.zeros(3), points, np.array([0.0, 0.0, 0.8]), 2.0)
    assert tracked.believed
    np.testing.assert_allclose(tracked.motion, [0.0, 0.0, 0.8], atol=1e-6)


def watched(scans, increments):
    """What a tracker makes of `scans`, in the robot frame, after the first has been written into the map."""
    workers = Workers(1)
    model, matcher = MotionModel(0.1, 0.2, 0.1, 0.2), ParticleScanMatcher(MatcherConfig(), workers)
    tracker, maps = Tracker(TrackingConfig(), matcher, model, 0.0), TileMaps(1, 0.05, 0.1, workers)
    maps.write(np.zeros((1, 3)), scans[0], np.ones(len(scans[0]), dtype=bool))
    for k in range(30):  # it has moved like that before
        tracker.track(maps, 0, np.zeros(3), scans[0], np.zeros(3), 0.1 * k)
        tracker._reach = np.array([1.5, 1.5])
    return tracker.track(maps, 0, np.zeros(3), scans[1], increments, 3.0)


def wall(n, distance, seed):
    """(n, 2) points on a wall across the way of the robot, 0.8 m wide and `distance` away."""
    across = np.linspace(-0.4, 0.4, n)
    return np.stack((np.random.default_rng(seed).normal(distance, 0.01, n), across), axis=1)


def corner(n, seed):
    """(n, 2) points on three walls, which only one pose explains."""
    side, noise = np.linspace(-2.0, 2.0, n // 3), np.random.default_rng(seed).normal(0.0, 0.01, n // 3)
    walls = ((side + 2.0, 2.0 + noise), (4.0 + noise, side), (side + 2.0, -2.5 + noise))
    return np.concatenate([np.stack(each, axis=1) for each in walls])


def test_a_few_beams_that_fit_elsewhere_do_not_make_the_odometry_a_liar():
    tracked = watched((wall(40, 2.0, 0), wall(40, 2.0, 1)), np.array([0.0, 0.0, 0.9]))  # a wall like the one before
    assert tracked.believed
    np.testing.assert_allclose(tracked.motion, [0.0, 0.0, 0.9], atol=0.05)


def test_a_scan_that_one_pose_alone_explains_does():
    tracked = watched((corner(120, 0), corner(120, 1)), np.array([0.8, 0.3, 0.9]))
    assert not tracked.believed
    np.testing.assert_allclose(tracked.motion, np.zeros(3), atol=0.03)


def candidate(value, explained, occam):
    return Candidate(np.zeros(3), 1e-4 * np.eye(3), value, 0.0, 0.0, 0.1, explained, occam)


@pytest.mark.parametrize(
    ("way", "others", "chosen"),
    [
        (0.1, [(-1.0, -2.0, -12.0)], 0),
        (0.1, [(-1.0, -2.0, -21.0)], None),  # 9 better, but for the poses that had been possible
        (0.1, [(-0.5, -2.0, -19.0), (-1.0, -2.0, -12.0)], 1),  # by the evidence, not by the best pose
        (0.1, [(-9.0, -2.0, -12.0)], None),  # it explains the scan badly
        (5.0, [(-9.0, -2.0, -12.0)], 0),  # but the odometry's way is impossible
        (5.0, [(-1.0, -2.0, -26.0)], 0),  # for which 8 are added
        (5.0, [(-1.0, -2.0, -35.0)], None),
    ],
)
def test_the_odometry_is_disbelieved_by_evidence_that_it_lies(monkeypatch, way, others, chosen):
    workers = Workers(1)
    matcher = ParticleScanMatcher(MatcherConfig(), workers)
    tracker = Tracker(TrackingConfig(lie=8.0), matcher, MotionModel(0.1, 0.2, 0.1, 0.2), 0.0)
    best, found = candidate(-12.0, -25.0, -4.0), [candidate(*other) for other in others]
    for name, told in (("refined", best), ("sampled", best), ("around", found), ("steady", candidate(-30, -99, 0))):
        monkeypatch.setattr(
            alignment.MapAlignment, name, lambda *_, told=told, **__: told if told is not found else [*told]
        )
    aligned = alignment.MapAlignment(TileMaps(1, 0.05, 0.1, workers), 0, np.ones((9, 2)), matcher, TrackingConfig())
    said, reach = np.array([way, 0.0, 0.0]), np.array([1.0, 1.0])
    got, believed = tracker._found(aligned, np.zeros(3), said, 0.01 * np.eye(3), reach)
    assert believed is (chosen is None)
    assert got is (best if chosen is None else found[chosen])


@pytest.mark.parametrize("points", [corner(24, 0), corner(240, 0)])
def test_evidence_counts_each_point_half_and_the_share_of_poses_that_the_scan_leaves(points):
    workers = Workers(1)
    matcher, maps = ParticleScanMatcher(MatcherConfig(weight=30.0), workers), TileMaps(1, 0.05, 0.1, workers)
    maps.write(np.zeros((1, 3)), points, np.ones(len(points), dtype=bool))
    prior, aside = np.diag([0.3, 0.3, 0.2]) ** 2, np.array([0.3, 0.3, 0.0])
    aligned = alignment.MapAlignment(maps, 0, points, matcher, TrackingConfig())
    found = aligned.refined(aside, aside, 1e-9 * np.eye(3))  # held where it fits badly
    n = len(matcher.thinned(points, 0.05))
    assert found.value == pytest.approx(-min(30, n) * (found.against + 0.4 * found.unknown), abs=1e-3)
    assert found.explained == pytest.approx(-0.5 * n * (found.against + 0.4 * found.unknown), abs=1e-3)
    found = aligned.refined(np.zeros(3), np.zeros(3), prior)
    share = np.sqrt(np.linalg.det(found.covariance) / np.linalg.det(prior))
    assert found.occam == pytest.approx(np.log(share))
    assert found.evidence == pytest.approx(found.explained + np.log(share))
    assert share < 1e-2


def test_a_pose_of_the_search_is_no_likelier_than_the_one_that_it_is_refined_to():
    workers, points = Workers(1), corner(120, 0)
    matcher, maps = ParticleScanMatcher(MatcherConfig(), workers), TileMaps(1, 0.05, 0.1, workers)
    maps.write(np.zeros((1, 3)), points, np.ones(len(points), dtype=bool))
    aligned = alignment.MapAlignment(maps, 0, points, matcher, TrackingConfig())
    reach = np.array([1.0, 0.5])
    covariance = np.diag(0.25 * np.array([1.0, 1.0, 0.5]) ** 2)
    refined = aligned.refined(np.zeros(3), np.zeros(3), covariance)
    for found in aligned.around(np.zeros(3), reach, -np.inf, -10.0)[:1]:
        assert found.occam <= refined.occam + 0.5
        np.testing.assert_allclose(found.pose, np.zeros(3), atol=0.05)
    aside = np.array([0.04, 0.04, 0.02])  # the search steps over the best pose, and may find it all the same
    assert aligned.around(aside, reach, -np.inf, refined.value)


def test_the_best_of_samples_is_chosen_by_as_many_points_as_there_are(monkeypatch):
    workers, told = Workers(1), []
    monkeypatch.setattr(alignment, "search_samples", lambda *arguments: told.append(arguments[4]))
    for n in (4, 90):
        points = np.stack((np.linspace(-4.5, 4.5, n), np.ones(n)), axis=1)
        matcher, maps = ParticleScanMatcher(MatcherConfig(weight=30.0), workers), TileMaps(1, 0.05, 0.1, workers)
        aligned = alignment.MapAlignment(maps, 0, points, matcher, TrackingConfig())
        aligned.sampled(np.zeros(3), 0.01 * np.eye(3), np.zeros((2, 3)))
    assert told == [4.0, 30.0]


@pytest.mark.parametrize(("points", "worth"), [(3, 3.0), (300, 30.0)])
def test_a_scan_moves_the_weights_by_as_many_beams_as_it_has(monkeypatch, points, worth):
    slam = GMapping(GMappingConfig(particles=8, threads=1, observation_gain=30.0))
    losses = np.linspace(0.0, 0.2, 8)
    matches = Matches(np.zeros((8, 3)), np.broadcast_to(1e-3 * np.eye(3), (8, 3, 3)), losses, points)
    monkeypatch.setattr(ParticleScanMatcher, "match", lambda *_: matches)
    scan = LaserScan(np.full(60, 2.0), np.linspace(-1.0, 1.0, 60), 0.1, 10.0)
    slam.update(np.zeros(3), scan)
    update = slam.update(np.array([0.6, 0.0, 0.0]), replace(scan, time_s=0.1, ranges=np.full(60, 1.4)))
    assert update.diagnostics["neff"] == pytest.approx(effective_number(normalised(-worth * losses)))


def test_the_scans_own_errors_are_not_taken_for_those_of_the_odometry():
    scales = [drive_with(0.1, 100, informative=1e-3, seed=seed).scale for seed in range(10)]
    np.testing.assert_array_less(np.mean(scales, axis=0), [0.7, 0.7, 0.5])


def test_every_matched_scan_teaches_how_good_the_odometry_is_and_a_frozen_one_is_not_trusted(monkeypatch):
    motions, said = [], []
    learn, covariance_at = MotionModel.learn, MotionModel.covariance_at
    monkeypatch.setattr(MotionModel, "learn", lambda *a: motions.append((a[0].mean, *a[1:])) or learn(*a))
    monkeypatch.setattr(MotionModel, "covariance_at", lambda *a: said.append(a[1]) or covariance_at(*a))
    slam, bearings = GMapping(GMappingConfig(particles=3, threads=1)), np.deg2rad(np.arange(-180.0, 180.0, 2.0))
    with np.errstate(divide="ignore"):
        for k in range(8):  # between two walls 2 m to the sides, and one 12 m ahead
            x, sine, cosine = 0.6 * k, np.sin(bearings), np.cos(bearings)
            ahead = np.where(cosine > 0, (12.0 - x) / cosine, (-3.0 - x) / cosine)
            ranges = np.minimum(np.abs(2.0 / sine), ahead)
            slam.update(np.array([0.5 * k, 0.0, 0.0]), LaserScan(ranges, bearings, 0.1, 30.0, 0.1 * k))
    assert len(motions) == len(said) == 7
    for mean, motion, prior, posterior in motions:
        np.testing.assert_allclose(mean, [0.5, 0.0, 0.0])
        np.testing.assert_allclose(motion, [0.6, 0.0, 0.0], atol=0.05)
        assert np.trace(posterior) < np.trace(prior)
    np.testing.assert_allclose(said, np.tile([0.6, 0.0, 0.0], (7, 1)), atol=0.05)


def test_points_in_one_square_take_part_once():
    workers = Workers(1)
    matcher, maps = ParticleScanMatcher(MatcherConfig(), workers), TileMaps(1, 0.05, 0.1, workers)
    points = np.repeat([[1.0, 0.01], [2.0, 0.01], [2.0, 0.51]], 20, axis=0)
    covariances = 0.01 * np.eye(3)[None]
    assert matcher.match(maps, points, np.zeros((1, 3)), covariances, np.random.default_rng(0)).points == 3
