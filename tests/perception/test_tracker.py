import dataclasses

import numpy as np
import pytest
from tagalong.perception.config import PRESETS, PerceptionConfig, perception_preset, table_ii
from tagalong.perception.tracking.config import (
    ConfirmationConfig,
    ReidentificationConfig,
    TerminationConfig,
    TrackerConfig,
)
from tagalong.slam import InputError

CARRIED = TrackerConfig(  # for a frame that moves with the robot: patient, and known again from far
    confirmation=ConfirmationConfig(gamma=0.35),
    termination=TerminationConfig(epsilon=2.0),
    reidentification=ReidentificationConfig(max_age_s=60.0, distance=6.0),
)


def test_table_two_is_what_every_method_has_and_people_in_recordings_are_hypotheses_by_default():
    c, printed = PerceptionConfig(), (0.13, 3, 0.3, 0.5, 0.9, 0.35, 0.1, 0.05, 0.1)
    assert tuple(table_ii(c)) == ("alpha", "beta", "gamma", "delta", "epsilon", "zeta", "c_min", "q", "r")
    assert tuple(table_ii(c).values()) == printed
    assert PRESETS["recorded"] == c
    assert PRESETS["table2"] == dataclasses.replace(c, method="leg pairs")
    assert c.method == "hypotheses"


def test_wrong_configurations_say_what_is_wrong():
    with pytest.raises(InputError, match="`delta` must be positive"):
        ConfirmationConfig(delta=-1.0)
    with pytest.raises(InputError, match=r"unknown preset 'table3'; presets: .*table2"):
        perception_preset("table3")


@pytest.mark.parametrize("rate_hz", [7.5, 10.0, 40.0])
def test_a_walker_becomes_one_person_at_the_true_place(make_stage, rate_hz):
    history, truth = make_stage(rate_hz=rate_hz).walk([[1.0, -1.0]], [[0.0, 1.2]], 4.0)
    assert [len(people) for people in history[: round(0.2 * rate_hz)]] == [0] * round(0.2 * rate_hz)
    assert all(list(people.ids) == [0] for people in history[round(1.5 * rate_hz) :])
    errors = np.array([p.positions[0] - t[0] for p, t in zip(history, truth, strict=True) if len(p)])
    errors = errors[2 * round(rate_hz) :]  # known from its first step on, when one foot stands: the velocity follows
    assert np.abs(errors.mean(axis=0)).max() < 0.03
    assert np.hypot(*errors.T).max() < 0.15
    assert history[-1].velocities[0] == pytest.approx([0.0, 1.2], abs=0.25)


def first_step(stage, confidence):
    """The people after each scan of one foot that swings 0.6 m past the other, which stands."""
    ways = np.concatenate((np.zeros(5), np.linspace(0.0, 0.6, 6), np.full(10, 0.6)))
    return [stage.show([[1.5, 0.0], [1.7, -0.3 + way]], confidence=confidence) for way in ways]


def test_two_sure_legs_are_a_person_from_the_first_step_and_doubtful_ones_wait_for_the_second(make_stage):
    sure, doubtful = first_step(make_stage(), 0.8), first_step(make_stage(), 0.4)
    assert len(sure[4]) == 0
    assert list(sure[-1].ids) == [0]
    assert sure[-1].positions[0] == pytest.approx([1.6, 0.15], abs=0.1)
    assert all(len(people) == 0 for people in doubtful)


def test_two_sure_things_of_which_one_is_mistaken_for_another_are_nobody(stage):
    table = np.array([[1.5, 0.0], [1.7, -0.3], [1.7, 0.25]])
    for k in range(100):  # the third leg looks human where the second did before
        human = np.array([True, k % 40 < 20, k % 40 >= 20])
        assert len(stage.show(table[human], table[~human])) == 0


def test_the_way_of_one_leg_makes_up_for_the_other_whose_track_began_late(make_stage):
    for late_way, started in ((0.3, True), (0.05, False)):
        stage = make_stage()
        for way in np.linspace(0.0, 0.9, 13):  # only one leg shows, doubtful
            assert len(stage.show([[1.5, way]], confidence=0.4)) == 0
        for k in range(8):
            people = stage.show([[1.5, 0.9], [1.7, 0.7 + min(1.0, k / 4) * late_way]], confidence=0.4)
        assert (len(people) == 1) == started


def test_a_sure_leg_alone_starts_a_person_when_it_moved_for_both_and_a_doubtful_one_never(make_stage):
    for confidence, started in ((0.8, True), (0.4, False)):
        stage = make_stage()
        counts = [len(stage.show([[1.5, y]], confidence=confidence)) for y in np.linspace(-1.0, 0.5, 25)]
        assert counts[:14] == [0] * 14  # 0.8 m
        assert (counts[-1] == 1) == started


@pytest.mark.parametrize("rate_hz", [10.0, 40.0])
def test_a_full_occlusion_of_one_second_keeps_the_identity(make_stage, rate_hz):
    history, _ = make_stage(rate_hz=rate_hz).walk(
        [[2.0, -2.0]], [[0.0, 1.0]], 5.0, hidden=lambda _, time_s: 2.5 <= time_s < 3.5
    )
    assert all(list(people.ids) == [0] for people in history[round(1.5 * rate_hz) :])


def test_two_people_who_cross_keep_their_identities(stage):
    history, truth = stage.walk([[1.5, -2.0], [2.1, 2.0]], [[0.0, 1.1], [0.0, -1.1]], 3.6)
    last = {int(i): p for i, p in zip(history[-1].ids, history[-1].positions, strict=True)}
    first = history[12]
    assert sorted(last) == sorted(first.ids)
    for number, position in zip(first.ids, first.positions, strict=True):
        who = int(np.argmin(np.hypot(*(truth[12] - position).T)))
        assert np.hypot(*(truth[-1][who] - last[int(number)])) < 0.3


def test_a_person_who_stands_still_after_walking_stays_a_person(stage):
    walked, truth = stage.walk([[2.0, -1.5]], [[0.0, 1.0]], 2.5)
    assert list(walked[-1].ids) == [0]
    stood = [stage.show(truth[-1][0] + np.array([[0.12, 0.0], [-0.12, 0.0]])) for _ in range(200)]
    assert all(list(people.ids) == [0] for people in stood)
    again, _ = stage.walk(truth[-1], [[0.0, 1.0]], 2.0)
    assert all(list(people.ids) == [0] for people in again)


def test_a_standing_person_hidden_for_long_is_met_again_without_walking(stage):
    walked, truth = stage.walk([[2.0, -2.0]], [[0.0, 1.0]], 5.0)
    legs = truth[-1][0] + np.array([[0.12, 0.0], [-0.12, 0.0]])
    shown = [stage.show(legs) for _ in range(20)]
    hidden = [stage.show(np.zeros((0, 2))) for _ in range(30)]
    again = [stage.show(legs) for _ in range(10)]
    assert list(walked[-1].ids) == list(shown[-1].ids) == list(again[-1].ids) == [0]
    assert len(hidden[-1]) == 0


def test_a_lost_person_of_whom_one_leg_shows_is_met_again_but_a_thing_there_before_is_not(make_stage):
    for standing_there_before in (False, True):
        stage = make_stage()
        post = np.array([[2.0, 4.4]])  # where the last speed leads, fading
        before = post if standing_there_before else np.zeros((0, 2))
        for k in range(50):
            feet = np.array([[1.9, -2.0 + 0.1 * k], [2.1, -2.0 + 0.1 * k]])
            feet[:, 1] += 0.25 * np.array([1.0, -1.0]) * np.cos(2 * np.pi * k / 10)
            stage.show(np.concatenate((feet, before)))
        assert len(stage.show(before)) == 1
        shown = [stage.show(before) for _ in range(15)][-1]
        again = [stage.show(post) for _ in range(10)][-1]
        assert (len(shown), list(again.ids)) == ((0, []) if standing_there_before else (0, [0]))


def test_standing_furniture_never_becomes_a_person_even_if_its_legs_look_human(stage):
    chair = np.array([[1.5, 0.0], [1.9, 0.0], [1.5, 0.4], [1.9, 0.4]])
    for _ in range(300):
        seen = stage.rng.random(4) < 0.7  # the forest says yes now and then
        assert len(stage.show(chair[seen], chair[~seen])) == 0


def test_a_track_that_hops_along_chair_legs_is_no_walker(stage):
    chair = np.stack((np.full(8, 1.5), 0.35 * np.arange(8)), axis=1)
    for k in range(200):  # one leg after the other looks human, the others stand there all the same
        human = np.isin(np.arange(8), [k // 3 % 8, (k // 3 + 1) % 8])
        assert len(stage.show(chair[human], chair[~human])) == 0


def test_clusters_below_gamma_never_start_a_person_and_block_their_cells(stage):
    history, _ = stage.walk([[1.0, -1.0]], [[0.0, 1.2]], 3.0, confidence=0.29)
    assert all(len(people) == 0 for people in history)
    wall = np.stack((np.full(160, 2.0), np.linspace(-2, 2, 160)), axis=1)
    for _ in range(10):
        stage.show(np.zeros((0, 2)), wall)
    history, _ = stage.walk([[2.0, -2.0]], [[0.0, 1.2]], 3.0, things=wall)
    assert all(len(people) == 0 for people in history)


def test_who_is_recognised_leaves_nobody_behind_to_be_met_again(make_stage):
    """A track that nobody was seen of for long is somebody who walks a metre beside it: it ends, and is nobody lost."""
    stage = make_stage(config=CARRIED)
    stage.walk([[2.0, -3.0]], [[0.0, 0.8]], 6.0)
    hidden = [stage.show(np.zeros((0, 2))) for _ in range(12)]
    assert len(hidden[-1]) == 1
    place = hidden[-1].positions[0]
    again, truth = stage.walk([place + np.array([1.1, 0.0])], [[0.8, 0.0]], 1.5)
    assert list(again[-1].ids) == [0]
    assert again[-1].positions[0] == pytest.approx(truth[-1][0], abs=0.15)
    chair = place + np.array([[0.0, 0.9], [0.2, 0.9]])  # where the track would have gone on; looks human
    for _ in range(20):
        assert list(stage.show(np.concatenate((chair, truth[-1][0] + np.array([[0.0, 0.1], [0.0, -0.1]])))).ids) == [0]


def test_legs_that_hide_each_other_keep_the_person_alive_and_in_place(stage):
    walked, truth = stage.walk([[1.5, -2.0]], [[0.0, 1.0]], 2.0)
    assert list(walked[-1].ids) == [0]
    errors = []
    for k in range(30):  # seen from the side: every other half second the legs are one cluster at their middle
        centre = truth[-1][0] + np.array([0.0, 0.1 * (k + 1)])
        feet = centre + np.array([[0.0, 0.25], [0.0, -0.25]]) * np.cos(2 * np.pi * k / 10)
        merged = abs(feet[0, 1] - feet[1, 1]) < 0.3
        people = stage.show(centre if merged else feet)
        assert list(people.ids) == [0]
        errors.append(people.positions[0] - centre)
    assert np.abs(np.mean(errors[10:], axis=0)).max() < 0.07
    assert np.hypot(*np.array(errors).T).max() < 0.25


def test_people_are_tracked_in_the_odometry_frame(stage):
    # the robot drives and turns beside a walker; seen from it, things move, in the odometry frame they stand
    for k in range(40):
        pose = np.array([0.05 * k, 0.0, 0.03 * k])
        turn = np.array([[np.cos(pose[2]), -np.sin(pose[2])], [np.sin(pose[2]), np.cos(pose[2])]])
        post = (np.array([[1.0, 1.0], [1.3, 1.0]]) - pose[:2]) @ turn
        assert len(stage.show(post, odometry=pose)) == 0


def test_two_runs_are_equal_and_a_reset_tracker_starts_anew(make_stage):
    first, second = make_stage(), make_stage()
    runs = [s.walk([[1.0, -1.0], [2.0, 1.0]], [[0.0, 1.2], [0.1, -1.0]], 3.0)[0] for s in (first, second)]
    for a, b in zip(*runs, strict=True):
        np.testing.assert_equal(dataclasses.asdict(a), dataclasses.asdict(b))
    first.tracker.reset()
    assert len(first.show(np.zeros((0, 2)))) == 0
    third, _ = first.walk([[1.0, -1.0]], [[0.0, 1.2]], 3.0)
    assert list(third[-1].ids) == [0]


def test_a_scan_that_is_not_later_is_refused(stage):
    stage.show(np.zeros((0, 2)))
    stage.scans -= 1
    with pytest.raises(InputError, match="scan times must increase"):
        stage.show(np.zeros((0, 2)))


@pytest.mark.parametrize(
    ("width", "beside", "seen"), [(0.3, 0.0, True), (0.1, 0.0, False), (0.7, 0.0, False), (0.3, 0.5, False)]
)
def test_legs_that_look_like_one_wide_thing_where_the_person_must_be_are_the_person_for_a_while(
    stage, width, beside, seen
):
    history, _ = stage.walk((2.0, -1.5), (0.0, 0.5), 4.0)
    assert list(history[-1].ids) == [0]
    stage.detector.width = width
    both = []
    for k in range(40):
        people = stage.show((), things=(2.0 + beside, 0.5 + 0.05 * k))
        both.append(len(people) == 1 and people.unseen_s[0] == 0.0)
    long = round(stage.config.merged_legs.duration_s * stage.rate_hz)
    if seen:
        assert all(both[: long - 6])
    assert not any(both[long:])
    assert any(both) == seen
