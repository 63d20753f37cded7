"""Pose and step of a laser since a keyframe, filtered: what one match says, what many say, and what it is sure of."""

import numpy as np
from tagalong.slam.geometry import between, compose
from tagalong.slam.scan_to_scan.steady_motion import SteadyMotion

PRECISE = np.diag([1e-6, 1e-6, 1e-6])
OPEN = np.diag([9.0, 1e-6, 1e-6])  # along x nothing is seen
STEP = np.array([0.1, 0.0, 0.0])
ALIKE = (0.01, 0.01)


def driven(steps, step=STEP, covariance=PRECISE, motion=None):
    motion, at = motion or SteadyMotion(), np.zeros(3)
    for _ in range(steps):
        at = compose(at, step)
        motion = motion.gone_on(ALIKE).matched(at, covariance)
    return motion


def test_the_step_is_learned_from_where_matches_have_the_laser():
    bend = np.array([0.1, 0.02, 0.05])
    motion = driven(6, bend)
    np.testing.assert_allclose(motion.step, bend, atol=2e-3)
    going_on = motion.gone_on(ALIKE)
    np.testing.assert_allclose(going_on.pose, compose(motion.pose, motion.step), atol=1e-12)
    assert going_on.sigma[0] > motion.sigma[0]


def test_where_a_direction_is_open_the_step_goes_on_and_what_is_known_shrinks():
    motion = driven(10).since_here()
    for _ in range(20):
        ahead = motion.gone_on(ALIKE)
        motion = ahead.matched(ahead.pose * (1.0, 0.0, 0.0), OPEN)  # it rests along x where it began
    np.testing.assert_allclose(motion.pose[0], 2.0, rtol=0.01)
    assert motion.sigma[0] > 0.3
    assert motion.P[1, 1] < 1e-5


def test_one_vague_match_hardly_changes_the_speed_and_a_precise_one_does():
    before = driven(10).since_here()
    vague, precise = (
        before.gone_on(ALIKE).matched(np.array([-0.05, 0.0, 0.0]), np.diag([sigma**2, 1e-6, 1e-6]))
        for sigma in (0.1, 1e-3)
    )
    assert vague.step[0] > 0.09
    assert precise.step[0] < -0.04


def test_wheels_that_tell_the_step_replace_the_one_that_went_on():
    motion = driven(10).moved(np.array([0.0, 0.0, 0.3]), (0.02, 0.03))
    np.testing.assert_allclose(motion.pose, compose(driven(10).pose, (0.0, 0.0, 0.3)), atol=1e-12)
    np.testing.assert_allclose(np.sqrt(np.diag(motion.P))[3:], [0.02, 0.02, 0.03])
    assert np.abs(motion.P[3:, :3]).max() > 0.0  # a match corrects both


def test_a_turn_is_averaged_across_the_cut_of_angles():
    motion = SteadyMotion(np.array([0.0, 0.0, 3.1])).gone_on(ALIKE).matched(np.array([0.0, 0.0, -3.1]), PRECISE)
    assert abs(motion.pose[2] - (2 * np.pi - 3.1)) < 0.01


def test_covariances_of_a_step_are_those_of_small_changes():
    rng = np.random.default_rng(0)
    sigma = np.array([0.01, 0.02, 0.03, 0.02, 0.01, 0.02])
    motion = SteadyMotion(np.array([1.0, -2.0, 0.7]), np.array([0.5, 0.3, 0.2]), np.diag(sigma**2))
    draws = rng.multivariate_normal(np.concatenate((motion.pose, motion.step)), motion.P, 40000)
    landed = compose(draws[:, :3], draws[:, 3:])
    stepped = motion.gone_on((0.0, 0.0))
    np.testing.assert_allclose(np.cov(between(stepped.pose, landed).T), rotated(stepped), atol=2e-5)


def rotated(motion):
    """Covariance of the pose in the frame of the laser there."""
    cos, sin = np.cos(motion.pose[2]), np.sin(motion.pose[2])
    turn = np.array([[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]])
    return turn @ motion.P[:3, :3] @ turn.T


def test_a_step_that_is_slowed_is_known_as_much_better_as_it_is_smaller():
    before = driven(3, motion=SteadyMotion())
    after = before.slowed(0.5)
    np.testing.assert_allclose(after.step, 0.5 * before.step)
    np.testing.assert_allclose(after.P[3:, 3:], 0.25 * before.P[3:, 3:])
    np.testing.assert_allclose(after.P[:3, 3:], 0.5 * before.P[:3, 3:])
    np.testing.assert_allclose(after.P[:3, :3], before.P[:3, :3])
