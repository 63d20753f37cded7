"""How precise odometry is, learned alike from scans that tell much and from scans that tell little."""

from dataclasses import replace

import numpy as np
import pytest
from tagalong.slam.geometry import between, compose
from tagalong.slam.graph.engine import Cartographer
from tagalong.slam.local.local_slam import LocalSlam, LocalSlamConfig
from tagalong.slam.local.odometry_precision import OdometryPrecision
from tagalong.slam.local.switching_motion import SwitchingMotion
from tagalong.slam.scan_to_grid.extrapolator import ExtrapolatorConfig, Prediction
from tagalong.slam.scan_to_grid.scan_matcher import GridMatch
from walls import cast

SIGMA = np.array([0.03, 0.02])  # of the error model [m, rad]
NOTHING = np.zeros(2)
USUAL = OdometryPrecision().shares


def learned(shares, told, before=0.0, scans=300, turned=0.0, seed=0):
    """Return the shares that are learned of odometry with `shares` (2,) from scans that know so much of the pose.

    Args:
        shares: Of the error model, translation and rotation.
        told: (3,) standard deviations of what scans tell, along two directions [m, m] and of the heading [rad].
        before: Standard deviation of the match before [m, rad].
        turned: Angle of the first direction [rad].
    """
    rng, precision = np.random.default_rng(seed), OdometryPrecision()
    turn = np.array([[np.cos(turned), -np.sin(turned), 0.0], [np.sin(turned), np.cos(turned), 0.0], [0.0, 0.0, 1.0]])
    curvature = turn @ np.diag(np.array(told) ** -2.0) @ turn.T
    for _ in range(scans):
        used = Prediction(np.zeros(3), np.hypot(precision.shares * SIGMA, before))
        off = rng.normal(0.0, np.hypot((shares * SIGMA)[[0, 0, 1]], before))
        alone = off + turn @ rng.normal(0.0, told)
        pose = np.linalg.solve(curvature + used.information, curvature @ alone)
        model = Prediction(np.zeros(3), SIGMA)
        precision.learn(model, np.full(2, before), used, GridMatch(pose, curvature, 0.6, False))
    return precision.shares


@pytest.mark.parametrize("shares", [(0.25, 0.25), (0.3, 0.9), (0.8, 0.4), (2.0, 3.0)])
@pytest.mark.parametrize("told", [(0.002, 0.002, 0.001), (0.01, 0.01, 0.006), (0.03, 0.03, 0.02)])
def test_it_is_learned_whatever_scans_tell(shares, told):
    found = np.mean([learned(np.array(shares), told, seed=seed) for seed in range(3)], axis=0)
    assert np.all(found > 0.45 * np.array(shares))
    assert np.all(found < 1.5 * np.array(shares))


def test_what_the_last_match_was_off_by_is_no_error_of_the_odometry():
    assert np.all(learned(np.array([0.3, 0.3]), (0.004, 0.004, 0.003), before=0.015) < 0.6)


def test_scans_that_tell_nothing_teach_nothing():
    np.testing.assert_allclose(learned(np.array([3.0, 3.0]), (1e3, 1e3, 1e3)), USUAL, atol=0.01)
    np.testing.assert_allclose(learned(np.array([0.2, 0.2]), (1.0, 1.0, 1.0)), USUAL, atol=0.05)


@pytest.mark.parametrize("turned", [0.0, 0.7, 2.0])
def test_along_a_corridor_nothing_is_learned_and_across_it_is(turned):
    across = learned(np.array([0.25, 0.25]), (0.003, 1e3, 0.003), turned=turned)
    assert 0.15 < across[0] < 0.4
    along = learned(np.array([2.0, 0.25]), (1e3, 0.003, 0.003), turned=turned)
    assert 1.5 < along[0] < 2.6


def test_what_was_long_ago_is_forgotten_and_a_match_that_is_wrong_altogether_counts_little():
    precision, curvature = OdometryPrecision(), np.diag([1e6, 1e6, 1e6])
    model = Prediction(np.zeros(3), SIGMA)

    def learn(x, scans):
        for k in range(scans):
            pose = np.array([x * (-1) ** k, 0.0, 0.0])
            precision.learn(model, NOTHING, model, GridMatch(pose, curvature, 0.6, False))
        return precision.shares[0]

    assert learn(0.001, 300) < 0.25
    assert learn(5.0, 3) < 0.35
    assert learn(0.09, 400) > 1.5


@pytest.mark.parametrize("turned", [0.0, 0.7, 2.0])
def test_what_a_scan_leaves_open_is_that_of_the_direction_of_which_it_tells_least(turned):
    cos, sin = np.cos(turned), np.sin(turned)
    turn = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    left = Prediction(np.zeros(3), SIGMA).sigma_after(turn @ np.diag([1e6, 1e2, 1e4]) @ turn.T)
    np.testing.assert_allclose(left, [(1e2 + 0.03**-2) ** -0.5, (1e4 + 0.02**-2) ** -0.5], rtol=1e-6)


def test_a_match_is_uncertain_until_its_scan_is_drawn():
    motion, curvature = SwitchingMotion(ExtrapolatorConfig()), np.diag([900.0, 900.0, 1600.0])
    steps = 0.05 * np.arange(5.0)[:, None] * [1.0, 0.0, 0.0]
    sigmas, left = [], np.zeros(2)
    for k, pose in enumerate(steps):
        hypotheses = motion.predict(pose, 0.1 * k)
        sigmas.append(hypotheses[0].prediction.sigma)
        model = motion.precision.shares * ExtrapolatorConfig().sigma(steps[min(k, 1)])
        np.testing.assert_allclose(sigmas[-1], np.hypot(model, left))
        motion.take(hypotheses, hypotheses[0], pose, -9.0, GridMatch(pose, curvature, 0.6, False))
        left = hypotheses[0].prediction.sigma_after(curvature)
    assert np.all(sigmas[3] > sigmas[1])
    motion.leave_open(np.zeros(2))
    model = motion.precision.shares * ExtrapolatorConfig().sigma(steps[1])
    np.testing.assert_allclose(motion.predict(0.25 * np.array([1.0, 0.0, 0.0]), 0.5)[0].prediction.sigma, model)


def test_a_place_found_far_from_where_it_was_expected_teaches_nothing_and_is_as_sure_as_it_was_drawn():
    motion, pose = SwitchingMotion(ExtrapolatorConfig()), np.array([0.5, 0.0, 0.0])
    shares = []
    for k in range(2):
        hypotheses = motion.predict(np.zeros(3), 0.1 * k)
        match = GridMatch(k * pose, np.eye(3), 0.6, False, retried=bool(k))
        motion.take(hypotheses, hypotheses[0], match.pose, -9.0, match)
        shares.append(motion.precision.shares)
    np.testing.assert_array_equal(*shares)
    first = motion.predict(np.zeros(3), 0.2)[0].prediction
    np.testing.assert_allclose(first.sigma, shares[0] * ExtrapolatorConfig().sigma(np.zeros(3)))


TURNS = np.array([0.0, 0.0, 0.0022])  # 1 degree in 8 scans


def taught(offs, heading=0.0, curvature=1e6):
    """Return the precision that matches teach which are off by `offs` (n,) [m] along x and y, at a `heading`."""
    precision = OdometryPrecision()
    model = Prediction(np.array([0.0, 0.0, heading]), SIGMA)
    for x in offs:
        pose = np.array([x, x, (heading + np.pi) % (2.0 * np.pi) - np.pi])
        precision.learn(model, NOTHING, model, GridMatch(pose, curvature * np.eye(3), 0.6, False))
    return precision.shares


def test_some_motions_are_as_rough_as_the_model_and_some_matches_wrong_without_the_odometry_being_rough():
    rng = np.random.default_rng(2)
    offs = rng.normal(0.0, 0.25 * SIGMA[0], 400)
    offs[::5] = rng.normal(0.0, SIGMA[0], 80)
    assert taught(offs)[0] < 0.35
    offs[::40] = 1.0
    assert taught(offs)[0] < 0.45
    assert 2.0 < taught(rng.normal(0.0, 3.0 * SIGMA[0], 400))[0] < 4.0


def test_headings_beside_half_a_turn_are_near_each_other():
    np.testing.assert_allclose(taught(np.zeros(50), heading=np.pi + 1e-6), taught(np.zeros(50)), rtol=1e-3)


def test_a_scan_that_tells_nothing_at_all_is_no_evidence():
    np.testing.assert_allclose(taught([0.5, 0.2], curvature=0.0), USUAL)


def test_what_happened_over_several_scans_is_no_error_of_one_motion():
    motion, curvature = SwitchingMotion(ExtrapolatorConfig()), 1e6 * np.eye(3)
    for k in range(3):
        hypotheses, pose = motion.predict(np.array([0.1 * k, 0.0, 0.0]), 0.1 * k), np.array([0.13 * k, 0.0, 0.0])
        match = None if k == 1 else GridMatch(pose, curvature, 0.6, False)
        shares = motion.precision.shares
        motion.take(hypotheses, hypotheses[0], pose, -9.0 if match else None, match)
    np.testing.assert_array_equal(motion.precision.shares, shares)


def test_scans_that_are_drawn_where_they_were_matched_leave_nothing_open():
    local, rng = LocalSlam(LocalSlamConfig()), np.random.default_rng(5)
    poses = np.outer(np.arange(0.0, 0.5, 0.06), np.array([1.0, 0.0, 0.0]))
    drawn, left = [], []
    for pose in poses:
        scan = cast(ROOM, pose, rng, bearings=BEARINGS)
        drawn.append(local.update(pose, scan).insertion is not None)
        left.append(local._motion._doubt)
    assert any(drawn)
    assert not all(drawn)
    np.testing.assert_array_equal(np.array(left)[drawn], 0.0)
    assert np.all(np.array(left)[~np.array(drawn)] > 0.0)
    local._motion._doubt = left[1]
    assert local._insert(poses[-1], scan, scan.points_robot, poses[-1] + 1.0, None)
    assert local._motion._doubt is left[1]  # it was not matched


BEARINGS = np.deg2rad(np.arange(-90.0, 91.0, 6.0))
ROOM = np.array([[-4.0, -3.0, 5.0, -3.0], [5.0, -3.0, 5.0, 4.0], [5.0, 4.0, -4.0, 4.0], [-4.0, 4.0, -4.0, -3.0],
                 [1.0, 1.5, 2.2, 1.5], [2.2, 1.5, 2.2, 2.5], [-2.0, -1.0, -1.2, -1.8]])  # fmt: skip


def test_thirty_beams_on_short_steps_hold_a_robot_whose_odometry_turns():
    phase, rng = np.linspace(0.0, 4.0 * np.pi, 700), np.random.default_rng(3)
    truth = np.stack((2.0 * np.sin(phase), -1.2 + 1.2 * np.cos(phase), -phase), axis=-1)
    odometry = [truth[0]]
    for motion in between(truth[:-1], truth[1:]):
        odometry.append(compose(odometry[-1], motion + TURNS))
    engine = Cartographer()
    for told, pose in zip(odometry, truth, strict=True):
        engine.update(told, cast(ROOM, pose, rng, bearings=BEARINGS))
    error = between(truth, engine.local_trajectory())
    assert np.abs(between(truth[-1], odometry[-1])[2]) > 1.4
    assert np.abs(error[:, 2]).max() < np.deg2rad(1.0)
    assert np.hypot(error[:, 0], error[:, 1]).max() < 0.06


@pytest.mark.parametrize(("score", "seen", "teaches"), [(0.6, 1.0, True), (0.1, 1.0, False), (0.1, 0.3, True)])
def test_a_scan_of_which_hardly_anything_fits_teaches_nothing(score, seen, teaches):
    motion = SwitchingMotion(ExtrapolatorConfig())
    for k in range(20):  # people who walk along draw every match back by half a step
        hypotheses = motion.predict(np.array([0.2 * k, 0.0, 0.0]), 0.1 * k)
        pose = np.array([0.1 * k, 0.0, 0.0])
        match = GridMatch(pose, np.diag([1e4, 1e4, 1e5]), score, False, seen=seen)
        motion.take(hypotheses, hypotheses[0], pose, 0.0, match)
    assert (motion.precision.shares[0] > 3.0 * USUAL[0]) == teaches
    assert teaches or motion.precision.shares[0] == pytest.approx(USUAL[0])


def test_in_a_hall_that_the_laser_hardly_sees_people_who_walk_along_do_not_hold_the_robot_back():
    rng, local = np.random.default_rng(0), LocalSlam(LocalSlamConfig())
    hall = np.array(
        [(-30.0, -20.0, 30.0, -20.0), (-30.0, 20.0, 30.0, 20.0)] + [(x, 3.0, x, 3.4) for x in range(0, 25, 6)]
    )
    for k in range(200):
        pose = np.array([0.1 * k, 0.0, 0.0])
        scan = cast(hall, pose, rng, reach=4.0)
        beside = np.abs(np.abs(scan.bearings) - 1.4) < 0.12
        people = np.where(beside, 0.7 + 0.05 * np.sin(k), np.inf)
        result = local.update(pose, replace(scan, ranges=np.minimum(scan.ranges, people)))
    assert abs(between(pose, result.pose)[0]) < 0.5
