import gzip
import os
from pathlib import Path

import numpy as np
import pytest
from tagalong.slam.errors import InputError
from tagalong.slam.geometry import compose
from tagalong.slam.logs.relations import Readings, Relations, read_readings, read_relations
from tagalong.slam.logs.tum import Trajectory
from tagalong.slam.quality.relations import readings_of_scans, relation_error, score_relations

DATA = os.environ.get("TAGALONG_DATA")


def test_errors_of_hand_computed_relations():
    # truth: 1 m ahead; and 2 m ahead with a quarter turn. estimates: 1.3 m ahead; 2 m ahead, 0.4 m left, 80 degrees
    relations = np.array([(1.0, 0.0, 0.0), (2.0, 0.0, np.pi / 2)])
    first = np.array([(5.0, 5.0, np.pi / 2), (1.0, 1.0, 0.0)])
    second = np.array([(5.0, 6.3, np.pi / 2), (3.0, 1.4, np.deg2rad(80))])
    error = relation_error(relations, first, second)
    assert error.translation.mean == pytest.approx(0.35)
    assert error.translation.std == pytest.approx(0.05)
    assert error.translation.max == pytest.approx(0.4)
    assert error.rotation.mean == pytest.approx(5.0)
    assert error.rotation.max == pytest.approx(10.0)
    assert error.translation_squared.mean == pytest.approx((0.09 + 0.16) / 2)


def test_relations_by_time_interpolate_the_trajectory_and_skip_what_it_does_not_cover():
    trajectory = Trajectory(np.array([0.0, 1.0, 2.0]), np.array([(0.0, 0, 3.1), (1.0, 0, -3.1), (2.0, 0, -3.1)]))
    relations = Relations(
        np.array([0.5, 0.0]), np.array([1.5, 9.0]), np.array([(-1.0, 0.0, 0.0), (0.0, 0.0, 0.0)]), by_reading=False
    )
    error = score_relations(trajectory, relations)
    assert error.skipped == 1
    assert error.translation.max < 0.05  # heading at 0.5 s is pi, not 0
    assert error.rotation.max == pytest.approx(np.rad2deg(np.pi - 3.1), abs=1e-6)


def test_relations_by_reading_carry_the_pose_on_by_odometry():
    odometry = np.array([(0.1 * i, 0.0, 0.0) for i in range(11)])
    readings = Readings(np.arange(11) * 0.2, odometry)
    turned = compose((3.0, 4.0, 1.0), odometry)
    trajectory = Trajectory(readings.times_s[[1, 6]], turned[[1, 6]])
    relations = Relations(np.array([0.0]), np.array([9.0]), np.array([(0.9, 0.0, 0.0)]), by_reading=True)
    error = score_relations(trajectory, relations, readings)
    assert error.translation.max < 1e-12
    with pytest.raises(InputError, match="need the odometry"):
        score_relations(trajectory, relations)
    far = Relations(np.array([0.0]), np.array([11.0]), np.zeros((1, 3)), by_reading=True)
    with pytest.raises(InputError, match="11 readings"):
        score_relations(trajectory, far, readings)


def test_a_foreign_clock_is_noticed():
    trajectory = Trajectory(np.array([0.0, 1.0]), np.zeros((2, 3)))
    relations = Relations(np.array([1e6]), np.array([1e6]), np.zeros((1, 3)), by_reading=False)
    with pytest.raises(InputError, match="clock"):
        score_relations(trajectory, relations)
    readings = Readings(np.array([0.0, 1.0]), np.zeros((2, 3)))
    with pytest.raises(InputError, match="clock"):
        score_relations(trajectory, relations, readings)
    one_foreign = Relations(np.array([0.0, 0.0]), np.array([1.0, 1e6]), np.zeros((2, 3)), by_reading=False)
    assert score_relations(trajectory, one_foreign, readings).skipped == 1


def test_scans_find_their_readings_where_the_clock_stood_still():
    readings = np.array([0.0, 0.1, 0.2, 0.3, 0.3, 0.3, 0.6, 0.7, 0.8, 0.9])
    assert readings_of_scans(readings[[0, 2, 4, 6, 8]], readings).tolist() == [0, 2, 4, 6, 8]


def test_both_layouts_are_read_and_mistakes_named(tmp_path):
    timed, indexed, readings = tmp_path / "a", tmp_path / "b", tmp_path / "c"
    timed.write_text("10.5 11.5 1 2 0 0 0 0.5\n")
    indexed.write_text("# i1 i2 x y yaw\n3 7 1 2 0.5\n")
    readings.write_text("# index\n0 10.0 0.0 1 2 3\n1 10.2 0.2 1 2 3\n")
    assert read_relations(timed).T_first_second.tolist() == [[1, 2, 0.5]]
    assert not read_relations(timed).by_reading
    assert read_relations(indexed).by_reading
    assert read_readings(readings).times_s.tolist() == [10.0, 10.2]
    timed.write_text("10.5 11.5 1 2 0 0 0 0.5\n1 2 3\n")
    with pytest.raises(InputError, match=r"a:2: .*got 3 words"):
        read_relations(timed)
    for file, line in ((timed, "10.5 nan 1 2 0 0 0 0.5\n"), (indexed, "3 7 inf 2 0.5\n")):
        file.write_text(line)
        with pytest.raises(InputError, match=":1: expected finite numbers"):
            read_relations(file)
    readings.write_text("0 10.2 0.2 1 nan 3\n")
    with pytest.raises(InputError, match="c:1: expected finite numbers"):
        read_readings(readings)
    readings.write_text("1 10.2 0.2 1 2 3\n")
    with pytest.raises(InputError, match="count from 0, got 1"):
        read_readings(readings)


@pytest.mark.skipif(DATA is None, reason="TAGALONG_DATA names no folder with the recorded logs")
def test_gmappings_own_trajectory_of_intel_scores_as_published():
    logs = Path(str(DATA)) / "slam_logs"
    corrected, last = [], ""
    with gzip.open(logs / "intel.gfs.log.gz", "rt") as lines:
        for line in lines:
            words = line.split()
            # a FLASER corrects the reading before it; the ODOM line after it repeats its pose and is no reading
            if words[0] == "ODOM" and last != "FLASER":
                corrected.append([float(w) for w in words[1:4]])
            if words[0] == "FLASER":
                corrected[-1] = [float(w) for w in words[-9:-6]]
            if words[0] in ("ODOM", "FLASER"):
                last = words[0]
    readings = read_readings(logs / "intel_readings_odometry.txt.gz")
    assert len(corrected) == len(readings.times_s)
    trajectory = Trajectory(readings.times_s, np.array(corrected))
    error = score_relations(trajectory, read_relations(logs / "intel_relations_by_reading.txt.gz"), readings)
    assert error.translation.mean == pytest.approx(0.044, abs=5e-4)
    assert error.translation.std == pytest.approx(0.037, abs=5e-4)
    assert error.translation.max == pytest.approx(0.235, abs=5e-3)
    assert error.rotation.mean == pytest.approx(1.9, abs=0.05)
    assert error.rotation.std == pytest.approx(1.6, abs=0.05)
    assert error.skipped == 0
