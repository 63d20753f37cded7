"""Which landmarks should have been seen: those whose beam goes on behind them."""

import numpy as np
from tagalong.slam.ekf.visibility import seen_through
from tagalong.slam.scan import LaserScan

BEARINGS = np.linspace(-np.pi / 2, np.pi / 2, 181)


def judged(ranges, landmarks, pose=(0.0, 0.0, 0.0)):
    scan = LaserScan(np.broadcast_to(ranges, 181).copy(), BEARINGS, 0.1, 8.0)
    return seen_through(np.array(landmarks), np.array(pose), scan, 0.3).tolist()


def test_a_beam_that_goes_on_says_that_nothing_is_there_and_one_that_ends_before_or_at_it_does_not():
    assert judged(6.0, [(3.0, 0.0), (3.0, 1.0)]) == [True, True]
    assert judged(3.0, [(3.0, 0.0), (5.0, 0.0)]) == [False, False]
    assert judged(3.9, [(3.0, 0.0)]) == [False]  # as near behind it as a thing is wide


def test_what_lies_behind_the_robot_or_at_the_end_of_the_range_or_was_not_measured_is_not_judged():
    assert judged(np.inf, [(-3.0, 0.0), (7.9, 0.0), (3.0, 0.0)]) == [False, False, True]
    assert judged(np.nan, [(3.0, 0.0)]) == [False]
    assert judged(6.0, [(-3.0, 0.0)], pose=(0.0, 0.0, np.pi)) == [True]
