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


def test_in_the_open_who_keeps_ahead_of_a_robot_that_turns_keeps_the_number(stage, step):
    told = []
    for k in range(80):  # there is no wall, and the odometry turns to and fro, up to 2.5 rad/s
        turn = np.sin((k - 15) / 4.0) if k > 15 else 0.0
        centre, time_s = np.array([1.8, 0.0]), k / stage.rate_hz
        told.append(stage.show(step(centre, (1.0, 0.0), time_s), odometry=(0.0, 0.0, turn)))
    assert {int(number) for people in told for number in people.ids} == {0}
    assert [len(people) for people in told[15:]] == [1] * 65


def test_a_robot_that_has_turned_and_stands_is_as_sure_of_a_place_as_one_that_never_did(make_stage, step):
    variances = []
    for pose in ((0.0, 0.0, 0.0), (4.0, 2.0, 1.5)):
        stage = make_stage()
        for k in range(30):
            people = stage.show(step(np.array([1.8, 0.0]), (1.0, 0.0), k / stage.rate_hz), odometry=pose)
        variances.append(float(people.variance[0]))
    assert variances[0] == pytest.approx(variances[1], rel=1e-6)


def test_where_walls_tell_that_the_frame_stands_still_a_turn_makes_no_place_less_sure(make_hall, step):
    variances = []
    for sway in (0.0, 0.5):
        hall = make_hall()
        for k in range(40):
            pose = np.array([0.0, 0.0, sway * np.sin(k / 2.0)])
            people = hall.show(step(np.array([2.0, 0.0]), (1.0, 0.0), k / hall.rate_hz), confidence=0.9, odometry=pose)
        variances.append(float(people.variance[0]))
    assert variances[1] == pytest.approx(variances[0], rel=0.05)


@pytest.mark.parametrize("at_first", [0.05, 0.005])  # a hypothesis begins, or none
@pytest.mark.parametrize(("wobble", "people"), [(0.0, 0), (3.0, 1)])
def test_what_has_stood_for_long_is_a_thing_only_as_far_as_walls_say_that_the_frame_stands_still(
    hall, at_first, wobble, people
):
    rng = np.random.default_rng(0)
    for k in range(90):  # they stand for eight seconds and look like nothing, then they look like legs
        pose = np.array([0.6 * np.sin(0.2 * k), 0.5, 0.0])
        true = pose + wobble * np.array([*rng.uniform(-1.0, 1.0, 2), 0.0])
        told = hall.show([[3.0, 0.0], [3.0, 0.3]], confidence=at_first if k < 60 else 0.8, odometry=pose, true=true)
    assert len(told) == people
