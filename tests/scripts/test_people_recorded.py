"""What `tagalong bench people-recorded` counts."""

from argparse import Namespace
from dataclasses import replace

import numpy as np
import pytest
from tagalong.perception import LegForest, PerceptionConfig
from tagalong.perception.tracking import NoLegs
from tagalong.scripts.benchmarks.people_recorded import Judge, judge_recording, leg_scores, read_people_recording, run
from tagalong.slam import InputError, LaserScan


def place(*xy):
    return np.array(xy, dtype=float).reshape(-1, 2)


def test_found_extra_and_changed_numbers_are_counted():
    judge = Judge()
    truth = np.array([5]), place(2, 0)
    judge.add(np.array([0, 1]), place(2.1, 0, 4, 0), place(2.1, 0, 4, 0), truth)
    judge.add(np.array([2, 1]), place(2.1, 0, 4, 0), place(2.1, 0, 5.5, 0), truth)
    judge.add(np.array([1]), place(4, 0), place(5.5, 0), truth)
    judge.add(np.array([7]), place(4, 0), place(4, 0), None)
    figures = judge.figures()
    assert figures["found"] == pytest.approx(2 / 3)
    assert figures["extra"] == figures["walked"] == 1.0
    assert (figures["switches"], figures["truths"], figures["numbers"]) == (1, 3, 4)
    assert figures["people"] == pytest.approx(6 / 4)


def test_who_was_met_in_one_scan_and_is_not_annotated_in_another_is_known():
    judge = Judge()
    judge.add(np.array([0, 3]), place(2, 0, 4, 0), place(2, 0, 4, 0), (np.array([5]), place(2, 0)))
    judge.add(np.array([0, 3]), place(2, 0, 4, 0), place(2, 0, 4, 0), (np.array([6]), place(9, 0)))
    assert judge.figures()["extra"] == 1.5
    assert judge.figures()["known"] == 0.5


def test_an_empty_hall_without_odometry_has_nobody(tmp_path):
    laser = {"angle_min": np.array(-1.0), "angle_increment": np.array(0.01), "range_min": np.array(0.1)}
    scans = {"ranges": np.full((4, 200), 3.0), "stamp": 0.1 * np.arange(4), "range_max": np.array(10.0)}
    with (tmp_path / "hall_scans.npz").open("wb") as file:
        np.savez(file, allow_pickle=False, **laser, **scans)
    recording = read_people_recording(tmp_path / "hall_scans.npz")
    judge = judge_recording(recording, PerceptionConfig(method="hypotheses"), [LegForest.load("real")] * 2)
    figures = judge.figures()
    assert (figures["people"], figures["truths"]) == (0.0, 0)


def test_a_folder_without_recordings_is_refused(tmp_path):
    with pytest.raises(InputError, match="no recordings"):
        run(Namespace(data=tmp_path))


def test_legs_are_found_at_a_rate_of_false_ones_on_the_people_free_recording():
    def seen(confidence, at=((1.0, 0.0), (3.0, 0.0))):
        nothing = NoLegs().detect(LaserScan(np.ones(2), np.array([0.0, 0.1]), 0.1, 8.0))
        return replace(nothing, positions=np.array(at), confidence=np.array(confidence))

    people, nobody = Judge(), Judge(scans=2)
    people.add_legs(seen([0.6, 0.9]), place(1.1, 0, 3.5, 0, 9, 0))
    people.add_legs(seen([0.2, 0.0]), place(1.1, 0))
    nobody.add_legs(seen([0.5, 0.1]), place())
    nobody.add_legs(seen([0.15, 0.1]), place())
    scores = leg_scores({"hall": people, "negative_2_left_scans": nobody})
    assert people.legs == [0.6, 0.0, 0.2]
    assert scores["0.1"] == pytest.approx(1 / 3)
    assert scores["0.5"] == pytest.approx(2 / 3)
    assert leg_scores({"hall": people}) == {}


def test_odometry_of_a_recording_can_be_left_aside(tmp_path):
    laser = {"angle_min": np.array(-1.0), "angle_increment": np.array(0.01), "range_min": np.array(0.1)}
    scans = {"ranges": np.full((4, 200), 3.0), "stamp": 0.1 * np.arange(4), "range_max": np.array(10.0)}
    odometry = {"odom_t_x_y_theta": np.array([[0.0, 0, 0, 0], [1, 1, 0, 0]])}
    with (tmp_path / "drive.npz").open("wb") as file:
        np.savez(file, allow_pickle=False, **laser, **scans, **odometry, tf_base_link__left_laser=np.zeros((1, 4)))
    said = read_people_recording(tmp_path / "drive.npz").poses
    np.testing.assert_allclose(said[:, 0], [0.0, 0.1, 0.2, 0.3])
    made = read_people_recording(tmp_path / "drive.npz", "scans").poses
    np.testing.assert_allclose(made, 0.0, atol=0.01)
