"""The tracker fed by a camera: people who never move, late pictures, people whom one sensor alone sees."""

import numpy as np
import pytest
from tagalong.perception.people_filter import near_points, points_lidar
from tagalong.perception.rgbd.people import RgbdPeople
from tagalong.perception.tracking.camera import NoLegs, SeenPeople
from tagalong.slam import LaserScan

LEGS = np.array([[2.0, 0.1], [2.0, -0.1]])


def seen(stage, *places, likelihood=0.95, delay_s=0.0):
    """What the camera saw `delay_s` before the scan that comes next."""
    now = (stage.scans + 1) / stage.rate_hz
    places = np.reshape(places, (-1, 2)).astype(float)
    return SeenPeople(now - delay_s, places, np.full(len(places), likelihood))


def test_somebody_who_never_moves_is_nobody_to_the_laser_and_a_person_to_the_camera_after_a_few_frames(make_hall):
    alone, both = make_hall(10.0), make_hall(10.0)
    assert [len(alone.show(LEGS)) for _ in range(60)] == [0] * 60
    counts = [len(both.show(LEGS, seen=seen(both, (2.05, 0.0)))) for _ in range(600)]
    assert counts[:2] == [0, 0]
    assert counts[5:] == [1] * 595


def test_returns_of_somebody_who_never_moves_are_removed_once_the_camera_saw_them(make_hall):
    angles = np.linspace(-0.5, 0.5, 101)
    ranges = np.full(101, 4.0)
    ranges[np.abs(angles - 0.05) < 0.02] = ranges[np.abs(angles + 0.05) < 0.02] = 2.0
    scan = LaserScan(ranges, angles, 0.1, 10.0)
    for camera, removed in ((False, 0), (True, 8)):
        stage = make_hall(10.0)
        for _ in range(6):
            people = stage.show(LEGS, seen=seen(stage, (2.05, 0.0)) if camera else None)
        kept = scan.without(near_points(scan, points_lidar(scan, people.points, np.zeros(3)), 0.35))
        assert np.count_nonzero(np.isnan(kept.ranges)) == pytest.approx(removed, abs=1)
        assert not np.isnan(kept.ranges[ranges == 4.0]).any()


def test_they_stay_a_person_when_the_camera_looks_away_and_the_legs_are_still_there(stage):
    for _ in range(5):
        stage.show(LEGS, seen=seen(stage, (2.05, 0.0)))
    people = [stage.show(LEGS) for _ in range(100)][-1]
    assert list(people.ids) == [0]
    assert people.positions[0] == pytest.approx([2.0, 0.0], abs=0.1)
    gone = [len(stage.show(np.empty((0, 2)))) for _ in range(60)]
    assert gone[-1] == 0


def test_a_walker_seen_by_both_is_one_person(stage):
    for k in range(40):
        centre = np.array([2.0, -1.5 + 0.1 * k])
        feet = centre + np.array([[0.1, 0.15 * np.sin(k)], [-0.1, -0.15 * np.sin(k)]])
        people = stage.show(feet, seen=seen(stage, centre))
    assert list(people.ids) == [0]


def test_a_picture_that_comes_three_tenths_of_a_second_late_leaves_no_lag(stage):
    errors = []
    for k in range(60):
        now = (stage.scans + 1) / stage.rate_hz
        then = np.array([8.0 - now + 0.3, -3.0 + 1.0 * (now - 0.3)])
        people = stage.show(np.empty((0, 2)), seen=seen(stage, then, delay_s=0.3))
        if k > 30:
            errors.append(people.positions[0] - (8.0 - now, -3.0 + now))
    assert np.abs(np.mean(errors, axis=0)).max() < 0.05


def test_one_frame_or_a_doubtful_detection_makes_nobody(make_stage):
    stage = make_stage()
    for k in range(40):  # now and then, at different places
        assert len(stage.show(np.empty((0, 2)), seen=seen(stage, (2.0, -2.0 + 0.1 * k) if k % 17 == 0 else ()))) == 0
    doubtful = make_stage()
    for _ in range(40):
        assert len(doubtful.show(LEGS, seen=seen(doubtful, (2.0, 0.0), likelihood=0.6))) == 0


@pytest.mark.parametrize(("every_s", "found"), [(0.4, True), (1.0, False)])
def test_frames_too_far_apart_are_each_the_first(stage, every_s, found):
    every = round(every_s * stage.rate_hz)
    counts = [
        len(stage.show(np.empty((0, 2)), seen=seen(stage, (2.0, 0.0)) if k % every == 0 else None))
        for k in range(8 * every)
    ]
    assert any(counts) == found


def test_where_the_laser_sees_legs_the_camera_changes_nothing_of_their_places(hall):
    for k in range(12):
        hall.show([[3.0, -1.0 + 0.12 * k], [3.0, -0.8 + 0.12 * k]], confidence=0.6)
    legs = np.array([[3.0, 0.44], [3.0, 0.64]])
    people = hall.show(legs, confidence=0.6, seen=SeenPeople(13 / 7.5, np.array([[3.1, 0.6]]), np.array([0.9])))
    places = people.seen_legs.positions
    assert places[np.argsort(places[:, 1])] == pytest.approx(legs)
    assert people.unseen_s[0] == 0.0


def test_two_people_seen_by_the_camera_alone_are_two_and_keep_their_numbers(stage):
    for k in range(50):
        places = [[2.0, -1.0 + 0.02 * k], [3.0, 1.0 - 0.02 * k]]
        people = stage.show(np.empty((0, 2)), seen=seen(stage, *places))
    assert sorted(people.ids) == [0, 1]
    assert people.positions[np.argsort(people.positions[:, 0])] == pytest.approx(np.array(places), abs=0.1)


def test_without_legs_the_laser_tells_nothing():
    scan = LaserScan(np.ones(5), np.linspace(-0.1, 0.1, 5), 0.1, 10.0)
    found = NoLegs().detect(scan)
    assert len(found) == 0
    assert len(found.clusters) == 0


def test_people_are_placed_by_the_pose_at_the_exposure():
    people = RgbdPeople(np.array([[2.0, 0.0]]), np.array([0.9]), np.full((2, 2), -1, dtype=np.int32))
    placed = SeenPeople.at_exposure(people, 1.5, (1.0, 1.0, np.pi / 2.0))
    assert placed.time_s == 1.5
    assert placed.positions[0] == pytest.approx([1.0, 3.0])
