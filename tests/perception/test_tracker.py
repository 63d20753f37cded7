"""People as hypotheses: one cluster, two legs or a hidden one, from standing and from moving robots."""

from types import SimpleNamespace

import numpy as np
import pytest
from halls import BEARINGS, scan_of, wall_from
from tagalong.perception import PeopleFilter, PeopleFilterConfig, perception_preset, table_ii
from tagalong.perception.config import PRESETS, PerceptionConfig
from tagalong.perception.legs.recent_views import RecentViewsConfig
from tagalong.perception.tracking.config import EvidenceConfig, ReidentificationConfig, TrackerConfig
from tagalong.perception.tracking.existence import has_come, stood_where
from tagalong.perception.tracking.numbers import numbers_of
from tagalong.perception.tracking.tracks import HYPOTHESIS, no_tracks, tracks_of
from tagalong.slam import InputError


def test_somebody_seen_as_one_doubtful_cluster_by_a_moving_robot_is_a_person_within_a_second(hall):
    counts = []
    for k in range(20):  # they meet at more than 2 m/s: 0.3 m between two scans
        people = hall.show([[5.0 - 0.16 * k, 0.6]], odometry=(0.13 * k - 1.5, 0.0, 0.0))
        counts.append(len(people))
    assert counts[0] == 0
    assert counts[8:] == [1] * 12
    assert people.positions[0] == pytest.approx([5.0 - 0.16 * 19, 0.6], abs=0.15)
    assert people.velocities[0] == pytest.approx([-1.2, 0.0], abs=0.3)


@pytest.mark.parametrize("beams", [lambda k: BEARINGS * (1.0 + 0.01 * (k % 3)), lambda k: BEARINGS[: -1 - k % 5]])
def test_somebody_is_known_as_soon_where_no_two_scans_have_the_same_beams(make_hall, beams):
    same, other = make_hall(), make_hall()
    for k in range(14):  # it comes out of a corner where nothing was; without memory of that it is nobody yet
        shown = {"places": [[3.0, 1.5 - 0.13 * k]], "confidence": 0.3, "odometry": (0.1 * k - 1.4, 0.0, 0.0)}
        counts = len(same.show(**shown)), len(other.show(**shown, bearings=beams(k)))
        assert counts[0] == counts[1]
    assert counts == (1, 1)


@pytest.mark.parametrize("rate_hz", [5.0, 10.0, 40.0])
def test_two_legs_that_step_are_one_person_at_any_rate(make_hall, step, rate_hz):
    hall = make_hall(rate_hz)
    counts = []
    for k in range(int(4 * rate_hz)):
        time_s = k / rate_hz
        people = hall.show(step(np.array([2.0, -2.0 + time_s]), (0.0, 1.0), time_s), confidence=0.5)
        counts.append(len(people))
    assert set(counts[int(1.5 * rate_hz) :]) == {1}
    assert list(people.ids) == [0]
    assert people.positions[0] == pytest.approx([2.0, 2.0], abs=0.25)


def test_furniture_is_nobody_to_a_robot_that_stands_and_to_one_that_drives_by(hall):
    chair = np.array([[1.5, 1.0], [1.9, 1.0], [1.5, 1.4], [1.9, 1.4]])
    for _ in range(40):
        assert len(hall.show(chair, confidence=0.3)) == 0
    for k in range(30):
        assert len(hall.show(chair, confidence=0.08, odometry=(0.1 * k, 0.0, 0.0))) == 0


def test_two_things_that_are_found_in_turn_are_nobody_who_steps_from_one_to_the_other(hall):
    posts = np.array([[2.0, 1.2], [2.0, 0.6]])
    for k in range(30):
        hall.scans += 1
        pose = np.array([0.05 * k, 0.0, 0.0])
        hall.detector.positions = (posts[[0]] if k % 4 < 2 else posts[[1]]) - pose[:2]
        hall.detector.confidence = np.array([0.4])
        scan = scan_of(posts - pose[:2], hall.scans / hall.rate_hz, wall=wall_from(pose))
        assert len(hall.tracker.update(scan, pose).people) == 0


def test_what_has_stood_still_is_a_person_only_when_it_moves(hall):
    for k in range(15):
        hall.show([[3.0, 0.0], [3.0, 0.3]], confidence=0.05, odometry=(0.1 * k, 1.0, 0.0))
    for k in range(15):  # then it looks like two legs, from wherever the robot drives
        people = hall.show([[3.0, 0.0], [3.0, 0.3]], confidence=0.6, odometry=(1.5 - 0.1 * k, 1.0, 0.0))
        assert len(people) == 0
    for k in range(15):
        people = hall.show([[3.0, 0.1 * k], [3.0, 0.3 + 0.1 * k]], confidence=0.6, odometry=(0.0, 1.0, 0.0))
    assert len(people) == 1


def test_somebody_who_walks_away_into_the_own_shadow_is_a_person(hall):
    counts = [len(hall.show([[1.2 + 0.13 * k, 0.0]], confidence=0.5)) for k in range(25)]
    assert counts[-8:] == [1] * 8


def test_somebody_who_walks_ahead_of_the_robot_at_its_own_pace_is_a_person(hall):
    for k in range(30):  # a step forward and none: 0.3 m nearer and farther before the laser
        sway = 0.15 * np.sin(2.0 * np.pi * k / 8)
        people = hall.show([[-2.0 + 0.13 * k + sway, 0.0]], confidence=0.4, odometry=(-4.0 + 0.13 * k, 0.0, 0.0))
    assert len(people) == 1


@pytest.mark.parametrize("from_scan", [0, 12])
def test_a_part_of_the_robot_is_nobody_however_much_it_looks_like_a_leg_and_however_far_it_drives(hall, from_scan):
    for k in range(from_scan):
        hall.show((), odometry=(-4.0 + 0.13 * k, 0.0, 0.0))
    for k in range(from_scan, 40):
        assert len(hall.show([[-3.2 + 0.13 * k, 0.2]], confidence=0.3, odometry=(-4.0 + 0.13 * k, 0.0, 0.0))) == 0


def test_two_legs_that_leave_no_doubt_are_a_person_though_something_has_stood_there(hall):
    legs = [[3.0, 0.0], [3.0, 0.3]]
    for k in range(15):
        hall.show(legs, confidence=0.05, odometry=(0.1 * k, 1.0, 0.0))
    for k in range(15):
        people = hall.show(legs, confidence=0.95, odometry=(1.5 - 0.1 * k, 1.0, 0.0))
    assert len(people) == 1


@pytest.mark.parametrize(("stood_s", "people"), [(2.0, 1), (60.0, 0)])
def test_the_longer_something_has_stood_the_more_it_takes_to_be_somebody(hall, stood_s, people):
    legs = [[3.0, 0.0], [3.0, 0.3]]
    for _ in range(int(stood_s * hall.rate_hz)):
        assert len(hall.show(legs, confidence=0.05, odometry=(0.0, 1.0, 0.0))) == 0
    told = [len(hall.show(legs, confidence=0.6, odometry=(0.1 * k, 1.0, 0.0))) for k in range(25)]
    assert told[-1] == people


def test_somebody_stands_where_something_stands_only_with_all_legs_that_are_seen():
    tracks = tracks_of(no_tracks(1, 8, RecentViewsConfig()), 0)
    rows = np.zeros(4, HYPOTHESIS).view(np.recarray)
    rows["clusters"] = [[0, 1], [1, 0], [1, -1], [-1, -1]]
    sight = SimpleNamespace(stood=np.array([0.0, 7.0]))
    numbers = SimpleNamespace(things_resolution=0.05, things_forget_s=3.0)
    stood = stood_where.py_func(tracks, rows, sight, 1.0, numbers)  # pyright: ignore[reportFunctionMemberAccess]
    assert stood.tolist() == [0.0, 0.0, 7.0, 0.0]


@pytest.mark.parametrize(
    ("legs", "came"), [((0, -1), False), ((1, -1), True), ((0, 1), True), ((-1, 1), True), ((-1, -1), False)]
)
def test_somebody_has_come_who_has_a_leg_where_nothing_was(legs, came):
    one, sight = SimpleNamespace(clusters=legs), SimpleNamespace(came=np.array([False, True]))
    assert has_come.py_func(one, sight) == came  # pyright: ignore[reportFunctionMemberAccess]


def test_somebody_whom_a_robot_without_odometry_follows_is_a_person_though_still_in_its_frame(hall):
    for k in range(60):
        true = np.array([-6.0 + 0.2 * k, 0.0, 0.0])  # the walls say that the frame does not stand still
        sway = 0.16 * (k // 8 % 2)  # and then a step aside
        legs = [[1.5, sway], [1.5, 0.3 + sway]]
        people = hall.show(legs, confidence=0.05 if k < 15 else 0.7, true=true)
    assert len(people) == 1


def test_a_leg_is_less_sure_where_something_has_stood_still_and_surer_where_nothing_has(hall):
    for k in range(10):
        hall.show([[2.0, 1.0]], confidence=0.3, odometry=(0.05 * k, 0.0, 0.0))
    hall.detector.positions, hall.detector.confidence = np.array([[2.0, 1.0], [2.0, -1.0], [3.0, -2.0]]), np.zeros(3)
    hall.detector.confidence[:2] = 0.3
    scan = scan_of(hall.detector.positions, 11 / hall.rate_hz)
    still, fresh, none = hall.tracker.update(scan, np.zeros(3)).detections.confidence[:3]
    assert still < 0.2 < 0.4 < fresh
    assert none == 0.0


def test_a_walker_hidden_for_a_second_keeps_the_number_and_one_who_vanished_in_plain_view_is_gone(hall, step):
    for k in range(25):
        people = hall.show(step(np.array([2.0, -2.0 + k / 7.5]), (0.0, 1.0), k / 7.5), confidence=0.6)
    assert list(people.ids) == [0]
    for _ in range(7):
        hall.show((), hidden=True)
    for k in range(33, 45):
        people = hall.show(step(np.array([2.0, -2.0 + k / 7.5]), (0.0, 1.0), k / 7.5), confidence=0.6)
    assert list(people.ids) == [0]
    gone = [len(hall.show(())) for _ in range(10)]
    assert gone[-1] == 0


def test_who_is_hidden_is_told_of_as_long_as_the_place_is_known_and_comes_back_as_a_young_track(hall, step):
    for k in range(25):
        people = hall.show(step(np.array([2.0, -2.0 + k / 7.5]), (0.0, 1.0), k / 7.5), confidence=0.6)
    assert people.age_s[0] > 3.0
    counts = [len(hall.show((), hidden=True)) for _ in range(5)]
    assert counts[0] == 1
    assert counts[-1] == 0
    people = hall.show(step(np.array([2.0, -2.0 + 30 / 7.5]), (0.0, 1.0), 30 / 7.5), confidence=0.6)
    assert list(people.ids) == [0]
    assert people.age_s[0] < 0.2


def test_two_people_who_cross_keep_their_numbers(hall, step):
    before: dict[int, float] = {}
    for k in range(30):
        time_s = k / 7.5
        ways = (np.array([2.0, -2.0 + time_s]), (0.0, 1.0)), (np.array([2.8, 2.0 - time_s]), (0.0, -1.0))
        people = hall.show(np.concatenate([step(*way, time_s) for way in ways]), confidence=0.6)
        if k == 12:
            before = dict(zip(people.ids.tolist(), people.positions[:, 0], strict=True))
    after = dict(zip(people.ids.tolist(), people.positions[:, 0], strict=True))
    assert sorted(before) == sorted(after)
    assert all(abs(before[number] - after[number]) < 0.4 for number in before)


def test_somebody_behind_another_keeps_the_own_leg_and_takes_none_of_the_other_one(hall, step):
    for k in range(30):  # both walk away from a robot that follows, the farther one is seen by one leg alone
        time_s, x = k / 7.5, 2.0 + k / 7.5
        legs = step(np.array([x, 0.0]), (1.0, 0.0), time_s), step(np.array([x + 1.1, 0.1]), (1.0, 0.0), time_s)[:1]
        people = hall.show(np.concatenate(legs), confidence=0.3, odometry=(k / 7.5, 0.0, 0.0))
    assert list(people.ids) == [0, 1]
    assert np.sort(people.positions[:, 0]) == pytest.approx([x, x + 1.1], abs=0.35)


def test_who_goes_out_of_sight_beside_a_post_is_not_that_post(hall):
    post = [[2.0, 0.0]]
    for k in range(15):  # there is nothing but a post at first
        hall.show(post, confidence=0.3, odometry=(0.05 * k, 0.0, 0.0))
    for k in range(20):
        people = hall.show([*post, [2.0, -2.0 + 0.1 * k]], confidence=0.6, odometry=(0.75, 0.0, 0.0))
    assert len(people) == 1
    counts = [len(hall.show(post, confidence=0.6, odometry=(0.75, 0.0, 0.0))) for _ in range(15)]
    assert counts[-1] == 0


@pytest.mark.parametrize("apart", [0.45, 0.6])
@pytest.mark.parametrize("ahead", [-0.2, 0.0, 0.1])
def test_who_comes_into_sight_beside_a_post_is_one_person_and_leaves_no_number_there(hall, step, apart, ahead):
    post, pose = [2.0, 0.0], np.array([0.6, 0.5, 0.0])
    for k in range(60):  # it has stood there for eight seconds and looks like a leg
        hall.show([post], confidence=0.6, odometry=(0.05 * min(k, 12), 0.5, 0.0))
    for k in range(12):
        centre = np.array([2.0 + apart, ahead + 0.13 * k])
        legs = step(centre, (0.0, 1.0), k / hall.rate_hz)[: 1 if k < 4 else 2]
        people = hall.show([post, *legs], confidence=[0.6, *[0.95] * len(legs)], odometry=pose)
        assert len(people) == 1
    assert people.positions[0] == pytest.approx(centre, abs=0.25)
    assert [len(hall.show([post], confidence=0.6, odometry=pose)) for _ in range(12)][-1] == 0


@pytest.mark.parametrize(("begin", "still"), [(3.0, True), (4.2, False)])
def test_where_somebody_stands_something_stands_unless_the_person_has_walked_there(hall, begin, still):
    for k in range(25):
        x, pose = max(3.0, begin - 0.15 * k), np.array([0.05 * k, 0.5, 0.0])
        people = hall.show([[x, 0.0], [x, 0.3]], confidence=0.95, odometry=pose)
    assert len(people) == 1
    hall.detector.confidence = np.full(2, 0.3)
    scan = scan_of(hall.detector.positions, 26 / hall.rate_hz, wall=wall_from(pose))
    confidence = hall.tracker.update(scan, pose).detections.confidence[:2]
    assert (confidence < 0.3).all() if still else (confidence > 0.3).all()


def test_what_has_stood_for_long_is_as_if_it_had_never_moved(hall):
    for k in range(75):  # walks for a second, stands for nine
        x, pose = max(3.0, 4.2 - 0.15 * k), np.array([0.02 * k, 0.5, 0.0])
        hall.show([[x, 0.0], [x, 0.3]], confidence=0.95, odometry=pose)
    hall.detector.confidence = np.full(2, 0.3)
    scan = scan_of(hall.detector.positions, 76 / hall.rate_hz, wall=wall_from(pose))
    assert (hall.tracker.update(scan, pose).detections.confidence[:2] < 0.3).all()


def test_what_is_taken_for_somebody_but_never_moves_is_not_believed_in_for_ever(hall):
    legs = [[3.0, 0.0], [3.0, 0.3]]
    counts = [len(hall.show(legs, confidence=0.55, odometry=(0.6 * np.sin(0.2 * k), 0.5, 0.0))) for k in range(450)]
    assert counts[20:200] == [1] * 180
    assert 0 in counts[200:]


def test_somebody_lost_is_believed_in_again_sooner_than_somebody_new(make_hall, step):
    def scans_until_seen(known):
        hall = make_hall()
        for k in range(25):
            hall.show(step(np.array([2.0, -2.0 + k / 7.5]), (0.0, 1.0), k / 7.5) if known else (), confidence=0.6)
        for _ in range(12):
            hall.show((), hidden=True)
        for k in range(20):
            if len(hall.show([[2.0, 2.0 + 0.1 * k]], confidence=0.2)):
                return k
        return 20

    assert scans_until_seen(known=True) < scans_until_seen(known=False)


@pytest.mark.parametrize(("hidden", "number"), [(60, 0), (80, 1)])
def test_who_comes_back_within_ten_seconds_has_the_old_number_and_later_a_new_one(hall, step, hidden, number):
    for k in range(25):
        hall.show(step(np.array([2.0, -2.0 + k / 7.5]), (0.0, 1.0), k / 7.5), confidence=0.6)
    for _ in range(hidden):
        hall.show((), hidden=True)
    for k in range(15):
        people = hall.show(step(np.array([2.0, 2.0 - k / 7.5]), (0.0, -1.0), k / 7.5), confidence=0.6)
    assert list(people.ids) == [number]


def test_who_appears_farther_away_than_somebody_lost_can_have_walked_has_a_new_number(hall, step):
    for k in range(25):
        hall.show(step(np.array([2.0, -2.0 + k / 7.5]), (0.0, 1.0), k / 7.5), confidence=0.6)
    for _ in range(9):
        hall.show((), hidden=True)
    for k in range(15):
        people = hall.show(step(np.array([6.0, -3.0 + k / 7.5]), (0.0, 1.0), k / 7.5), confidence=0.6)
    assert list(people.ids) == [1]


def test_who_was_there_before_somebody_was_lost_is_not_that_one(hall, step):
    def legs(x, k):
        return step(np.array([x, -2.0 + k / 7.5]), (0.0, 1.0), k / 7.5)

    for k in range(25):
        hall.show(np.concatenate((legs(2.0, k), legs(3.2, k))), confidence=0.6)
    for k in range(25, 40):
        people = hall.show(legs(3.2, k), confidence=0.6)
    assert len(people) == 1
    assert people.positions[0, 0] == pytest.approx(3.2, abs=0.3)
    before = people.ids[0]
    for k in range(40, 50):
        people = hall.show(legs(3.2, k), confidence=0.6)
        assert list(people.ids) == [before]


def test_legs_of_what_is_likelier_a_thing_are_not_told_of(hall):
    for k in range(10):
        people = hall.show([[2.5, 1.0]], confidence=0.1, odometry=(0.05 * k, 0.0, 0.0))
    assert len(people) == len(people.seen_legs) == 0
    for k in range(12):
        people = hall.show([[2.5, 1.0], [2.0, -2.0 + 0.15 * k]], confidence=0.5, odometry=(0.5, 0.0, 0.0))
    assert list(people.seen_legs.owner) == [0]


def test_whom_nobody_saw_come_is_not_believed_in_by_looks_before_it_is_known_whether_it_stands(hall):
    legs = [[3.0, 0.0], [3.0, 0.3]]
    counts = [len(hall.show(legs, confidence=0.4, odometry=(0.12 * k, 1.0, 0.0))) for k in range(4)]
    assert counts == [0, 0, 0, 0]
    assert len(hall.show(legs, confidence=0.95, odometry=(0.48, 1.0, 0.0))) == 1


def test_who_comes_where_nothing_was_is_a_person_before_what_stands_could_be_known_to_stand(hall):
    for _ in range(10):
        hall.show(())
    assert len(hall.show([[3.0, -1.0], [3.0, -0.8]], confidence=0.25)) == 1


def test_a_leg_that_shows_itself_beside_somebody_seen_by_one_is_the_other_one(make_hall):
    hall = make_hall(40.0)
    for _ in range(60):
        hall.show(())
    assert len(hall.show([[3.0, 0.0]], confidence=0.95)) == 1
    assert list(hall.show([[3.0, 0.0], [3.0, 0.42]], confidence=0.95).seen_legs.owner) == [0, 0]


def test_two_runs_are_equal_and_a_reset_tracker_starts_anew(make_hall):
    first, second = make_hall(), make_hall()
    for k in range(20):
        places = [hall.show([[3.0, -1.0 + 0.12 * k]]).positions for hall in (first, second)]
        np.testing.assert_array_equal(*places)
    assert len(places[0]) == 1
    first.tracker.reset()
    assert len(first.show([[3.0, 0.0]])) == 0


def test_what_makes_no_sense_is_refused(hall):
    hall.show(())
    hall.scans -= 1
    with pytest.raises(InputError, match="scan times must increase"):
        hall.show(())
    with pytest.raises(InputError, match="`look` must be positive"):
        EvidenceConfig(look=0.0)
    with pytest.raises(InputError, match="`distance` must be positive"):
        ReidentificationConfig(distance=-1.0)
    with pytest.raises(InputError, match=r"unknown preset 'table3'; presets: .*ye2021"):
        perception_preset("table3")
    with pytest.raises(InputError, match="unknown method 'guess'"):
        PeopleFilter(PeopleFilterConfig(method="guess"))


def test_table_two_is_what_every_method_has_and_people_are_hypotheses_by_default():
    c, printed = PerceptionConfig(), (0.13, 3, 0.3, 0.5, 0.9, 0.35, 0.1, 0.05, 0.1)
    assert tuple(table_ii(c)) == ("alpha", "beta", "gamma", "delta", "epsilon", "zeta", "c_min", "q", "r")
    assert tuple(table_ii(c).values()) == printed
    assert PRESETS["recorded"] == c
    assert c.method == "hypotheses"


def test_the_numbers_of_kernels_are_those_of_the_configuration():
    config = TrackerConfig()
    numbers = numbers_of(config)
    assert numbers["association_pace"] == config.association.pace
    assert numbers["reidentification_overlap_s"] == config.reidentification.overlap_s
    assert all(numbers.dtype[name] == np.float64 for name in numbers.dtype.names)
    left_out = {"views_count", "existence_gamma"}  # not asked by kernels
    nodes = {name: vars(node) for name, node in vars(config).items()}
    assert set(numbers.dtype.names) | left_out == {f"{name}_{key}" for name, node in nodes.items() for key in node}


def test_there_is_room_for_any_number_of_hypotheses(hall):
    ring = 4.0 * np.stack((np.cos(BEARINGS[::6]), np.sin(BEARINGS[::6])), axis=1)  # 128 posts, 0.15 m apart
    for _ in range(3):
        hall.show(ring[::3], confidence=0.6)
        hall.show(ring, confidence=0.6)
    grown = hall.tracker.update(scan_of(ring, 9.0), np.zeros(3))
    assert len(grown.detections) >= 128
