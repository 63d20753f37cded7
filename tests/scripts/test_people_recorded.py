"""What `tagalong bench people-recorded` counts."""

from argparse import Namespace

import numpy as np
import pytest
from tagalong.perception import LegForest, PerceptionConfig
from tagalong.scripts.benchmarks.people_recorded import Judge, judge_recording, read_people_recording, run
from tagalong.slam import InputError


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


def test_an_empty_hall_without_odometry_has_nobody(tmp_path):
    laser = {"angle_min": np.array(-1.0), "angle_increment": np.array(0.01), "range_min": np.array(0.1)}
    scans = {"ranges": np.full((4, 200), 3.0), "stamp": 0.1 * np.arange(4), "range_max": np.array(10.0)}
    with (tmp_path / "hall_scans.npz").open("wb") as file:
        np.savez(file, allow_pickle=False, **laser, **scans)
    recording = read_people_recording(tmp_path / "hall_scans.npz")
    figures = judge_recording(recording, PerceptionConfig(method="hypotheses"), [LegForest.load("real")] * 2)
    assert (figures["people"], figures["truths"]) == (0.0, 0)


def test_a_folder_without_recordings_is_refused(tmp_path):
    with pytest.raises(InputError, match="no recordings"):
        run(Namespace(data=tmp_path))
