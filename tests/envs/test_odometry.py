"""Wheel odometry: its named qualities, and its independence of the update rate."""

import numpy as np
import pytest
from tagalong.envs.robot.odometry import QUALITIES, WheelOdometry, odometry_quality
from tagalong.slam import InputError
from tagalong.slam.geometry import compose


def drive(quality, seed, metres=10.0, turn=0.0, steps=400):
    odometry = WheelOdometry(QUALITIES[quality], np.random.default_rng(seed), np.zeros(3))
    pose, step = np.zeros(3), np.array([metres / steps, 0.0, turn / steps])
    for _ in range(steps):
        pose = compose(pose, step)
        odometry.update(pose)
    return odometry.pose, pose


def test_perfect_odometry_is_the_truth():
    believed, true = drive("perfect", 0, turn=2.0)
    assert believed == pytest.approx(true, abs=1e-9)


@pytest.mark.parametrize(
    ("quality", "worst_way", "worst_heading"), [("good", 0.05, 0.3), ("typical", 0.2, 1.5), ("slipping", 1.0, 5.0)]
)
def test_systematic_errors_keep_within_the_documented_bounds(quality, worst_way, worst_heading):
    config = QUALITIES[quality]
    ends = np.array([drive(quality, seed)[0] for seed in range(80)])
    sigma_way, sigma_turn = config.alpha3 * np.sqrt(10.0), config.alpha2 * np.sqrt(10.0)
    assert np.abs(ends[:, 0] - 10.0).max() < worst_way + 4.0 * sigma_way + 0.1 * worst_way
    assert np.degrees(np.abs(ends[:, 2]).max()) < worst_heading + np.degrees(4.0 * sigma_turn)
    assert np.abs(ends[:, 0] - 10.0).max() > 0.6 * worst_way
    assert np.degrees(np.abs(ends[:, 2]).max()) > 0.6 * worst_heading


def test_qualities_are_ordered():
    spread = [np.std([drive(q, s, turn=6.0)[0][0] for s in range(40)]) for q in ("good", "typical", "slipping")]
    assert spread[0] < spread[1] < spread[2]


def test_random_errors_do_not_depend_on_the_rate_of_updates():
    slow, fast = (np.std([drive("slipping", s, steps=n)[0][2] for s in range(150)]) for n in (20, 400))
    assert slow == pytest.approx(fast, rel=0.3)


def test_an_unknown_quality_is_answered_with_the_known_ones():
    with pytest.raises(InputError, match="good, perfect, slipping, typical"):
        odometry_quality("superb")


def test_several_motions_at_once_are_the_same_motions_one_by_one():
    poses = np.cumsum(np.random.default_rng(4).normal(0.0, 0.05, (8, 3)), axis=0)
    once, one_by_one = (WheelOdometry(QUALITIES["slipping"], np.random.default_rng(1), np.zeros(3)) for _ in range(2))
    for pose in poses:
        one_by_one.update(pose)
    np.testing.assert_array_equal(once.update(poses), one_by_one.pose)
    np.testing.assert_array_equal(once.last_true, poses[-1])
