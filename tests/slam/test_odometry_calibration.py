"""Wheels of the wrong size: what they do to odometry is learned from matched scans, and only where scans tell it."""

import numpy as np
import pytest
from tagalong.slam import make_slam
from tagalong.slam.geometry import between, compose
from tagalong.slam.local.local_slam import LocalResult
from tagalong.slam.local.matched_steps import MatchedSteps
from tagalong.slam.local.odometry_calibration import OdometryCalibration
from tagalong.slam.scan_to_grid.scan_matcher import GridMatch
from walls import cast

CLEAR = np.diag([1e4, 1e4, 1e5])  # information of a scan that tells the place to centimetres
CORRIDOR = np.diag([0.0, 1e4, 1e5])  # and along a corridor


def steps(way, each=0.25, turn=0.0):
    """Return the true steps (n, 3) of a drive of `way` [m] that turns by so much each step."""
    return np.tile((each, 0.0, turn), (round(way / each), 1))


def told(truth, way=1.0, turn=1.0, drift=0.0):
    """Return the odometry of true steps (n, 3) whose factors are these."""
    poses = [np.zeros(3)]
    for x, y, theta in truth:
        wheels = (theta - drift * x / way) / turn
        ahead = compose((0.0, 0.0, 0.5 * (wheels - theta)), (x / way, y / way, 0.0))  # along the arc that is told
        poses.append(compose(poses[-1], (*ahead[:2], wheels)))
    return np.array(poses)


def learned(truth, odometry, information=CLEAR):
    calibration = OdometryCalibration()
    calibration.apply(odometry[0])
    for step, pose in zip(truth, odometry[1:], strict=True):
        calibration.apply(pose)
        calibration.learn(step, information)
    return calibration


@pytest.mark.parametrize("factors", [(0.8, 1.0, 0.0), (1.25, 1.0, 0.0), (1.0, 1.1, 0.0), (1.0, 1.0, 0.05)])
def test_factors_are_learned_within_a_hundred_metres(factors):
    truth = np.concatenate((steps(50, turn=0.1), steps(50, turn=-0.08)))
    calibration = learned(truth, told(truth, *factors))
    np.testing.assert_allclose(calibration.factors, factors, atol=0.03)


def test_calibrated_odometry_moves_as_the_robot_does():
    truth = steps(120, turn=0.05)
    odometry = told(truth, way=0.85)
    calibration = learned(truth, odometry)
    here = calibration.apply(odometry[-1])
    there = calibration.apply(compose(odometry[-1], (1.0, 0.0, 0.0)))
    assert between(here, there)[0] == pytest.approx(0.85, abs=0.03)


def test_before_anything_is_learned_odometry_is_as_it_is_told():
    odometry, calibration = told(steps(20, turn=0.1)), OdometryCalibration()
    np.testing.assert_allclose([calibration.apply(pose) for pose in odometry], odometry, atol=1e-9)


def test_a_corridor_says_nothing_of_the_way():
    truth = steps(100)
    calibration = learned(0.8 * truth, told(truth, drift=0.04), CORRIDOR)
    assert calibration.factors[0] == pytest.approx(1.0, abs=1e-5)


def test_what_one_stretch_says_is_not_believed_at_once():
    truth = steps(5)
    assert learned(0.6 * truth, told(truth)).factors[0] > 0.75


def test_one_wrong_stretch_does_not_undo_what_was_learned():
    truth = steps(100)
    matched = truth.copy()
    matched[200:220] *= 0.4
    assert learned(matched, told(truth)).factors[0] > 0.97


def test_factors_that_change_are_learned_anew():
    truth = steps(150)
    odometry = np.concatenate((told(truth), compose((150.0, 0.0, 0.0), told(truth, way=0.9)[1:])))
    calibration = learned(np.concatenate((truth, truth)), odometry)
    assert calibration.factors[0] == pytest.approx(0.9, abs=0.03)


def noisy(truth, turn, seed=0):
    """Return the odometry of a drive (n, 3) each step of which is off by a `turn`, a standard deviation [rad]."""
    off = np.random.default_rng(seed).normal(0.0, turn, len(truth))
    poses = [np.zeros(3)]
    for motion, wrong in zip(truth, off, strict=True):
        poses.append(compose(poses[-1], np.add(motion, (0.0, 0.0, wrong))))
    return np.array(poses)


def test_how_far_off_odometry_leads_is_what_is_known_of_odometries_until_something_is_learned():
    linear, angular = OdometryCalibration().drift(20.0)
    assert angular > 1.0
    assert linear > 10.0
    assert OdometryCalibration().drift(0.0).tolist() == [0.0, 0.0]


@pytest.mark.parametrize(("turn", "seed"), [(0.002, 0), (0.01, 1), (0.03, 2)])
def test_how_far_off_odometry_leads_is_learned_and_hardly_less_than_it_is(turn, seed):
    truth = steps(150)
    calibration = learned(truth, noisy(truth, turn, seed))
    for way in (10.0, 40.0):
        off = [noisy(steps(way), turn, 100 + k)[-1] - np.array([way, 0.0, 0.0]) for k in range(200)]
        aside, turned = np.std([np.hypot(*p[:2]) for p in off]), np.std([p[2] for p in off])
        linear, angular = calibration.drift(way)
        assert 0.9 * turned < angular < 2.0 * turned + 0.06
        assert 0.8 * aside < linear < way * angular


def test_odometry_that_has_become_rough_is_told_as_rough():
    truth, turn = steps(600), 0.03
    odometry = noisy(truth, np.where(np.arange(len(truth)) < 1800, 0.001, turn))
    assert learned(truth, odometry).drift(10.0)[1] > 0.75 * turn * np.sqrt(40)


def test_over_a_way_that_nobody_saw_a_turn_that_odometry_does_not_tell_cannot_be_made_good():
    truth = steps(150)
    straight, bent = learned(truth, told(truth)), learned(truth, told(truth, drift=0.03))
    assert bent.drift(30.0)[1] == pytest.approx(np.hypot(straight.drift(30.0)[1], 0.9), abs=0.15)


def test_a_corridor_does_not_make_odometry_precise():
    truth = steps(100)
    seen, unseen = (learned(truth, told(truth), information).drift(5.0)[0] for information in (CLEAR, CORRIDOR))
    assert unseen > 1.5 * seen


def test_backing_turns_the_other_way():
    truth = np.concatenate((steps(60), -steps(60)))
    calibration = learned(truth, told(truth, drift=0.05))
    assert calibration.factors[2] == pytest.approx(0.05, abs=0.02)


def test_graph_slam_learns_the_wheels_of_its_robot():
    room = np.array([[-4.0, -3.0, 5.0, -3.0], [5.0, -3.0, 5.0, 4.0], [5.0, 4.0, -4.0, 4.0], [-4.0, 4.0, -4.0, -3.0]])
    bearings, rng = np.deg2rad(np.arange(-135.0, 135.0, 1.5)), np.random.default_rng(0)
    phase = np.linspace(0.0, 8.0 * np.pi, 400)
    truth = np.stack((2.0 * np.sin(phase), -1.2 + 1.2 * np.cos(phase), -phase), axis=-1)
    odometry, engine = [truth[0]], make_slam("cartographer")
    for motion in between(truth[:-1], truth[1:]):
        odometry.append(compose(odometry[-1], motion * [1.15, 1.15, 1.0]))
    for pose, told in zip(truth, odometry, strict=True):
        engine.update(told, cast(room, pose, rng, bearings=bearings))
    way, turn, turn_per_metre = engine.calibration.factors
    assert way == pytest.approx(1.0 / 1.15, abs=0.03)
    assert turn + turn_per_metre * 1.15 * 1.63 == pytest.approx(1.0, abs=0.03)  # both, on circles of some 1.63 m


@pytest.mark.parametrize("wrong", [{"odometry_fault": True}, {"contradicts": True}, {"jumped": True}, {"waits": True}])
def test_nothing_is_learned_where_a_scan_was_not_matched_as_usual(wrong):
    def followed(**flags):
        calibration, steps = OdometryCalibration(), MatchedSteps()
        waits = flags.pop("waits", False)
        for k in range(60):
            calibration.apply(np.array([0.25 * k, 0.0, 0.0]))
            pose = np.array([0.2 * k, 0.0, 0.0])
            match = GridMatch(pose, CLEAR, 0.6, False)
            result = LocalResult(pose, match, None, **(flags if k % 2 else {}))
            if step := steps.follow(result, waits and bool(k % 2)):
                calibration.learn(*step)
        return calibration.factors[0]

    assert followed() < 0.9
    assert followed(**wrong) == 1.0


def test_points_that_err_alike_tell_less_of_a_step():
    steps, match = MatchedSteps(), GridMatch(np.zeros(3), CLEAR, 0.6, False)
    assert steps.follow(LocalResult(np.zeros(3), match, None), False) is None
    _, information = steps.follow(LocalResult(np.zeros(3), match, None), False)
    np.testing.assert_allclose(information, match.told)
    assert match.told[0, 0] < 0.5 * CLEAR[0, 0]
