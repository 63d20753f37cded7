"""Odometry from scans alone, in a room whose path is known."""

from dataclasses import replace

import numpy as np
import pytest
from tagalong.slam.errors import InputError
from tagalong.slam.geometry import between, compose
from tagalong.slam.scan_to_scan import Match
from tagalong.slam.scan_to_scan import laser_odometry as laser_odometry_module
from tagalong.slam.scan_to_scan.laser_odometry import LaserOdometryConfig, ScanToScanOdometry, laser_odometry
from walls import cast

ROOM = np.array(
    [(-4, -3, 5, -3), (5, -3, 5, 4), (5, 4, -4, 4), (-4, 4, -4, -3), (1, 0, 1, 1), (1, 1, 2, 1), (-2, -3, -2, -1.5)],
    dtype=float,
)
MOUNT = (0.2, 0.05, 0.4)


class Blind:
    """A matcher that finds nothing."""

    def match(self, reference, new, guess):
        return Match(np.zeros(3), np.eye(3), 0.0, False, 0)


def drive(steps=40, speed=0.1, turn=0.04, mount=MOUNT):
    """True poses from the origin on, along a bend, and the scans at them, at 10 Hz."""
    rng, poses = np.random.default_rng(0), [np.zeros(3)]
    for _ in range(steps):
        poses.append(compose(poses[-1], (speed, 0.0, turn)))
    scans = [
        replace(cast(ROOM, compose(pose, mount), rng, noise=0.005), time_s=0.1 * k, T_robot_lidar=mount)
        for k, pose in enumerate(poses)
    ]
    return np.array(poses), scans


def off(truth, poses):
    """Distance [m] and angle [rad] of each pose from the truth, (n,) and (n,)."""
    error = between(truth, poses)
    return np.hypot(error[:, 0], error[:, 1]), np.abs(error[:, 2])


def test_a_bend_is_followed_and_the_first_pose_is_the_origin():
    truth, scans = drive()
    made = laser_odometry(scans)
    away, turned = off(truth, made.poses)
    assert made.matched.all()
    np.testing.assert_array_equal(made.poses[0], 0.0)
    assert away.max() < 0.03
    assert turned.max() < 0.01


@pytest.mark.parametrize("blind", [1, 2])
def test_blind_scans_cost_nothing_once_the_laser_sees_again(blind):
    truth, scans = drive()
    for k in range(20, 20 + blind):
        scans[k] = scans[k].without(np.ones(len(scans[k]), dtype=bool))
    made = laser_odometry(scans)
    np.testing.assert_array_equal(np.flatnonzero(~made.matched), np.arange(20, 20 + blind))
    away, turned = off(truth, made.poses)
    assert away[20 + blind :].max() < 0.03
    assert turned[20 + blind :].max() < 0.01
    # meanwhile the robot goes on
    assert away[20 : 20 + blind].max() < 0.03


def test_it_is_told_how_well_a_step_is_known_as_its_odds_are_before_a_blind_scan_slows_it():
    _, scans = drive()
    scans[20] = scans[20].without(np.ones(len(scans[20]), dtype=bool))
    front_end = ScanToScanOdometry()
    sigmas = np.array([front_end.update(scan).sigma for scan in scans])
    np.testing.assert_array_equal(sigmas[0], 0.0)
    assert sigmas[10].max() < 0.03
    assert sigmas[20, 0] == pytest.approx(np.hypot(sigmas[19, 0], 0.02 + 1.0 * 0.1**2), rel=0.02)
    assert sigmas[20, 1] == pytest.approx(np.hypot(sigmas[19, 1], 0.05 + 2.0 * 0.1**2), rel=0.02)
    assert sigmas[-1].max() < 0.03


def test_a_robot_of_which_nothing_is_seen_comes_to_rest():
    _, scans = drive(steps=10)
    blind = scans[-1].without(np.ones(len(scans[-1]), dtype=bool))
    made = laser_odometry([*scans, *(replace(blind, time_s=1.0 + 0.1 * k) for k in range(1, 201))])
    went = np.hypot(*np.diff(made.poses[:, :2], axis=0).T)
    assert went[10] > 0.08
    np.testing.assert_allclose(went[15], 0.5 * went[10], rtol=0.02)  # after half a second
    assert went[-1] < 1e-6


HALL = np.array([(-20, -15, 25, -15), (25, -15, 25, 12), (25, 12, -20, 12), (-20, 12, -20, -15), (8, 2, 9, 5)], float)


def check_turns_in_a_hall(turns, stamp):
    """Walls that are far move by metres when the robot turns, and a matcher that looks a metre around finds nothing."""
    rng, poses = np.random.default_rng(0), [np.zeros(3)]
    for turn in turns:
        poses.append(compose(poses[-1], (0.1 * (turn is not None), 0.0, turn or 0.0)))
    scans = [replace(cast(HALL, pose, rng), time_s=stamp(k)) for k, pose in enumerate(poses)]
    made = laser_odometry(scans)
    away, turned = off(np.array(poses), made.poses)
    assert made.matched.all()
    assert away.max() < 0.1
    assert turned.max() < 0.01


def test_a_turn_farther_than_a_matcher_looks_is_found():
    check_turns_in_a_hall((0.0, 0.0, 0.35, 0.35, 0.0, -0.35, -0.35, 0.0), lambda k: 0.2 * k)


def test_stamps_of_arrival_are_late_and_then_in_bursts():
    stands = [None] * 59
    check_turns_in_a_hall((*stands, 0.0, 0.0, 0.35, 0.35, 0.0, 0.0), lambda k: np.floor(k / 5) + 1e-3 * (k % 5))


def test_along_a_smooth_corridor_the_robot_goes_on_as_before():
    posts = [(x, side, x, 0.7 * side) for x in (-2.0, -1.0, 0.5, 1.5, 2.5, 3.5) for side in (-1.0, 1.0)]
    walls = np.array([(-50, -1, 50, -1), (-50, 1, 50, 1), *posts, (-3, -1, -3, 1)], dtype=float)
    rng, truth = np.random.default_rng(0), np.stack((0.1 * np.arange(120), np.zeros(120), np.zeros(120)), axis=-1)
    scans = [replace(cast(walls, pose, rng, 6.0, 0.005), time_s=0.1 * k) for k, pose in enumerate(truth)]
    made = laser_odometry(scans)
    away, turned = off(truth, made.poses)
    assert made.matched.mean() > 0.95
    assert away.max() < 1.2  # of 11.9 m, more than half of which show nothing of the way
    assert turned.max() < 0.02


def test_a_vague_match_that_is_wrong_does_not_stop_the_robot(monkeypatch):
    sigmas, off = [0.001] * 6 + [0.04] + [3.0] * 10, [0.0] * 6 + [-0.15] + [0.0] * 10

    class Matcher:
        def match(self, reference, new, guess):
            k, (x, y, _) = round(10 * new.time_s), guess
            known = 0.1 * k if k <= 7 else x
            P = np.diag([sigmas[k - 1] ** 2, 1e-6, 1e-6])
            return Match(np.array([known + off[k - 1], y, 0.0]), P, 0.95, True, 5)

    monkeypatch.setattr(laser_odometry_module, "make_matcher", lambda name, **_: Matcher())
    front_end = ScanToScanOdometry(LaserOdometryConfig(keyframe_way=100.0))
    scan = cast(ROOM, (0.0, 0.0, 0.0), np.random.default_rng(0))
    updates = [front_end.update(replace(scan, time_s=0.1 * k)) for k in range(18)]
    assert all(update.matched for update in updates)
    np.testing.assert_allclose(updates[-1].pose[0], 1.7, atol=0.15)  # the corridor shows nothing of the last metre


def test_where_a_fifth_of_a_scan_is_nowhere_else_an_open_direction_is_no_match(monkeypatch):
    class Matcher:
        score = 0.95

        def match(self, reference, new, guess):
            return Match(np.asarray(guess), np.diag([9.0, 1e-6, 1e-6]), self.score, True, 5)

    matcher = Matcher()
    monkeypatch.setattr(
        laser_odometry_module, "make_matcher", lambda name, **_: Blind() if name == "global" else matcher
    )
    front_end, scan = ScanToScanOdometry(), cast(ROOM, (0.0, 0.0, 0.0), np.random.default_rng(0))
    assert front_end.update(scan).matched
    assert front_end.update(scan).matched
    matcher.score = 0.7
    assert not front_end.update(scan).matched


def test_what_a_search_shows_by_a_few_points_is_no_place():
    _, scans = drive(steps=4)
    front_end = ScanToScanOdometry()
    front_end.update(scans[0])
    few = scans[1].without(np.arange(len(scans[1])) % 12 > 0)
    assert few.is_return.sum() < 30
    turned = replace(cast(ROOM, compose((0.0, 0.0, 0.9), MOUNT), np.random.default_rng(2)), T_robot_lidar=MOUNT)
    assert front_end.update(turned.without(np.arange(len(turned)) % 12 > 0)).matched is False


@pytest.mark.parametrize(
    ("places", "covariance", "matched"),
    [
        ([(0.1, 0.0, 0.9)], 1e-4, True),
        ([(0.1, 0.0, 0.9)], 9.0, False),  # a direction is open
        ([(0.1, 0.0, 0.9), (0.5, 0.4, 0.6)], 1e-4, False),  # the robot can have gone to both
        ([(9.0, 0.0, 0.9), (0.1, 0.0, 0.9)], 1e-4, True),  # only to the second
    ],
)
def test_a_search_tells_where_the_robot_is_if_it_can_be_at_one_place_only(monkeypatch, places, covariance, matched):
    class Search:
        def match(self, reference, new, guess):
            found, others = np.array(places[0]), np.array(places[1:]).reshape(-1, 3)
            P = np.diag([covariance, 1e-4, 1e-4])
            return Match(found, P, 0.9, not len(others), 5, ambiguous=len(others) > 0, alternatives=others)

    monkeypatch.setattr(
        laser_odometry_module, "make_matcher", lambda name, **_: Search() if name == "global" else Blind()
    )
    scan = cast(ROOM, (0.0, 0.0, 0.0), np.random.default_rng(0))
    update = [front_end.update(each) for front_end in [ScanToScanOdometry()] for each in (scan, scan)][1]
    assert update.matched == matched
    np.testing.assert_allclose(update.pose, (0.1, 0.0, 0.9) if matched else np.zeros(3), atol=1e-3)


def test_a_leap_is_not_believed():
    _, scans = drive(steps=12)
    far = replace(cast(ROOM, compose((3.0, -1.0, 2.5), MOUNT), np.random.default_rng(1)), T_robot_lidar=MOUNT)
    made = laser_odometry([*scans[:8], replace(far, time_s=0.8), replace(far, time_s=0.9)])
    assert made.matched[:8].all()
    assert not made.matched[8]
    assert np.hypot(*(made.poses[8] - made.poses[7])[:2]) < 0.15


def test_no_scan_and_one_scan_are_no_motion():
    assert laser_odometry([]).poses.shape == (0, 3)
    one = laser_odometry(drive(steps=0)[1])
    np.testing.assert_array_equal(one.poses, np.zeros((1, 3)))
    assert one.matched.tolist() == [True]


CHEAP = {
    "icp": {},
    "mbicp": {},
    "hglasm-g-small": {},
    "global": {"second_maxima": 0, "window.linear": 0.3, "window.angular": 0.3},
}


@pytest.mark.parametrize("name", CHEAP)
def test_any_matcher_makes_odometry_and_refines_that_of_bad_wheels(name):
    truth, scans = drive(steps=12)
    config = LaserOdometryConfig(matcher=name, settings=CHEAP[name])
    for odometry in (None, truth * (1.15, 1.15, 1.1)):
        made = laser_odometry(scans, config, odometry)
        away, turned = off(truth, made.poses)
        assert made.matched.mean() > 0.8
        assert away.max() < 0.05  # the wheels end 0.18 m off
        assert turned.max() < 0.04


def test_along_a_corridor_the_wheels_count_and_across_it_the_scans():
    walls, rng = np.array([(-50, -1, 50, -1), (-50, 1, 50, 1)], dtype=float), np.random.default_rng(0)
    truth = np.stack((0.1 * np.arange(20), np.zeros(20), np.zeros(20)), axis=-1)
    scans = [cast(walls, pose, rng, noise=0.005) for pose in truth]
    drifting = truth + np.stack((np.zeros(20), 0.02 * np.arange(20), 0.01 * np.arange(20)), axis=-1)
    refined = laser_odometry(scans, odometry=drifting).poses
    np.testing.assert_allclose(refined[:, 0], truth[:, 0], atol=0.05)
    np.testing.assert_allclose(refined[:, 1:], truth[:, 1:], atol=0.02)


def test_where_the_scans_say_nothing_the_wheels_go_on_and_their_frame_is_kept():
    truth, scans = drive(steps=4)
    odometry = compose((5.0, -2.0, 1.0), truth)
    blind = [scan.without(np.ones(len(scan), dtype=bool)) for scan in scans]
    made = laser_odometry(blind, odometry=odometry)
    np.testing.assert_allclose(made.poses, odometry, atol=1e-12)
    assert made.matched.tolist() == [True, False, False, False, False]
    np.testing.assert_allclose(laser_odometry(scans, odometry=odometry).poses, odometry, atol=0.02)


def test_bad_settings_are_named():
    with pytest.raises(InputError, match="unknown scan matcher 'ipc'; scan matchers: glasm, "):
        LaserOdometryConfig(matcher="ipc")
    with pytest.raises(InputError, match="scan matcher 'icp': unknown IterativeConfig field 'wibble'"):
        laser_odometry([], LaserOdometryConfig(matcher="icp", settings={"wibble": 1}))
    with pytest.raises(InputError, match="`most_way` must be positive, got 0"):
        LaserOdometryConfig(most_way=0.0)
