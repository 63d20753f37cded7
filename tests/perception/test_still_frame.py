"""How far a frame stands still, by walls that are met again in it."""

import numpy as np
import pytest
from tagalong.perception.tracking.still_frame import FRAME, StillFrameConfig, judge_frame, points_of_walls, stillness
from tagalong.slam import InputError


class Frame:
    """A frame that is judged scan by scan."""

    def __init__(self):
        self.config, self.rows = StillFrameConfig(), np.zeros(1, FRAME)

    def update(self, shares, dt):
        judge_frame(self.rows[0], shares, dt, self.config.memory_s)

    @property
    def known(self):
        return stillness(self.rows[0], self.config.doubt)


def judged(shares, scans=10, count=50):
    frame = Frame()
    for _ in range(scans):
        frame.update(np.tile(shares, (count, 1)), 0.1)
    return frame.known


def test_nothing_is_known_before_a_wall_is_seen():
    assert Frame().known == 0.0
    assert judged([0.0, 0.0]) == 0.0


def test_walls_that_are_met_again_say_that_it_stands_and_walls_that_are_not_that_it_does_not():
    assert judged([0.0, 1.0]) == 1.0
    assert judged([0.1, 0.6]) == 1.0
    assert judged([0.5, 0.4]) == 0.0
    assert 0.3 < judged([0.35, 0.65]) < 0.7


def test_glass_and_people_before_a_third_of_the_walls_change_nothing():
    frame = Frame()
    for _ in range(10):
        frame.update(np.array([[0.0, 1.0]] * 40 + [[1.0, 0.0]] * 20), 0.1)
    assert frame.known == 1.0


def test_a_frame_that_slips_is_known_no_more_within_a_second_and_some_again_afterwards():
    frame = Frame()
    for k in range(30):
        frame.update(np.tile([0.0, 1.0] if k < 10 or k >= 20 else [1.0, 0.0], (50, 1)), 0.1)
        if k == 19:
            assert frame.known < 0.1
    assert frame.known > 0.9


@pytest.mark.parametrize(("most", "kept"), [(100, 70), (70, 70), (50, 35), (10, 10)])
def test_of_walls_no_more_returns_are_asked_than_allowed_evenly(most, kept):
    wall, post = np.stack((np.full(70, 3.0), 0.1 * np.arange(70)), axis=1), np.full((5, 2), 2.0)
    points, start, end = np.concatenate((wall[:40], post, wall[40:])), np.array([0, 40, 45]), np.array([40, 45, 75])
    asked = points_of_walls(points, start, end, most)
    assert len(asked) == kept
    np.testing.assert_array_equal(asked, wall[:: -(-70 // most)])


def test_numbers_that_make_no_sense_are_refused():
    with pytest.raises(InputError, match="`points` must be within 1"):
        StillFrameConfig(points=0)
