"""The usual step between two scans, and what is too far for it."""

import numpy as np
import pytest
from tagalong.slam.local.usual_step import UsualStep


def learned(stamps, metres=0.2):
    step = UsualStep()
    for stamp in stamps:
        step.tick(stamp)
        step.learn(np.array([metres, 0.05]))
    return step


def test_without_time_a_step_may_be_as_much_longer_as_it_is_and_with_it_as_a_robot_speeds_up():
    timed, untimed = learned(0.2 * np.arange(60.0)), learned(np.zeros(60))
    np.testing.assert_allclose(untimed.change, untimed.size)
    np.testing.assert_allclose(timed.change, [0.2**2, min(2.0 * 0.2**2, timed.size[1])], rtol=1e-2)


def test_stamps_that_run_backwards_take_no_time_away():
    steady, backwards = 0.2 * np.arange(60.0), 0.2 * np.arange(60.0)
    backwards[30:] -= 50.0
    for scans in (31, 32, 60):
        np.testing.assert_allclose(learned(backwards[:scans]).change[0], learned(steady[:scans]).change[0], rtol=0.25)


@pytest.mark.parametrize(("way", "since_s", "gap"), [(1.0, 0.0, False), (3.0, 11.6, False), (3.0, 6.0, True)])
def test_a_way_beyond_reach_is_a_gap_if_there_was_time_for_it(way, since_s, gap):
    step = learned(0.2 * np.arange(60.0))  # the last stamp is 11.8 s
    assert step.skips(way, 1, since_s) == gap
    assert not step.skips(way, 8, since_s)  # eight scans on it lies within reach


def test_nobody_goes_without_odometry_farther_than_some_metres():
    assert learned(np.zeros(60)).reach(1000) == pytest.approx(5.0)
