"""How far a frame stands still, by walls that are met again in it."""

import numpy as np
import pytest
from tagalong.perception.tracking.still_frame import StillFrame, StillFrameConfig
from tagalong.slam import InputError


def judged(shares, scans=10, count=50):
    frame = StillFrame(StillFrameConfig())
    for _ in range(scans):
        frame.update(np.tile(shares, (count, 1)), 0.1)
    return frame.known


def test_nothing_is_known_before_a_wall_is_seen():
    assert StillFrame(StillFrameConfig()).known == 0.0
    assert judged([0.0, 0.0]) == 0.0


def test_walls_that_are_met_again_say_that_it_stands_and_walls_that_are_not_that_it_does_not():
    assert judged([0.0, 1.0]) == 1.0
    assert judged([0.1, 0.6]) == 1.0
    assert judged([0.5, 0.4]) == 0.0
    assert 0.3 < judged([0.35, 0.65]) < 0.7


def test_glass_and_people_before_a_third_of_the_walls_change_nothing():
    frame = StillFrame(StillFrameConfig())
    for _ in range(10):
        frame.update(np.array([[0.0, 1.0]] * 40 + [[1.0, 0.0]] * 20), 0.1)
    assert frame.known == 1.0


def test_a_frame_that_slips_is_known_no_more_within_a_second_and_some_again_afterwards():
    frame = StillFrame(StillFrameConfig())
    for k in range(30):
        frame.update(np.tile([0.0, 1.0] if k < 10 or k >= 20 else [1.0, 0.0], (50, 1)), 0.1)
        if k == 19:
            assert frame.known < 0.1
    assert frame.known > 0.9


def test_numbers_that_make_no_sense_are_refused():
    with pytest.raises(InputError, match="`points` must be positive"):
        StillFrameConfig(points=0)
