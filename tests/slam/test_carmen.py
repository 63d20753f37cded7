import gzip
import os
from pathlib import Path

import numpy as np
import pytest
from tagalong.slam.errors import InputError
from tagalong.slam.logs.carmen import read_carmen

FLASER = "FLASER 4 1.0 2.0 {far} 0.0 {pose} {odom} 12.5 host 12.6"
ROBOT = (
    "ROBOTLASER1 0 -1.0 2.0 0.5 8.0 0.01 0 5 1.0 0.0 8.0 inf 7.9 {remission} {laser} {robot} 0 0 0 0 0 99.5 host 99.6"
)


def write(path: Path, *lines: str) -> Path:
    path.write_text("\n".join(lines) + "\n")
    return path


def flaser(pose="1 2 0.5", odom="1 2 0.5", far="50.0"):
    return FLASER.format(pose=pose, odom=odom, far=far)


def test_flaser_gives_ranges_bearings_odometry_and_no_reference_when_both_poses_agree(tmp_path):
    drive = read_carmen(write(tmp_path / "a.log", "# comment", "", flaser(), flaser("2 2 4", "2 2 4", "49.9")))
    assert len(drive) == 2
    assert drive.name == "a"
    assert drive.reference is None
    np.testing.assert_allclose(drive.odometry, [[1, 2, 0.5], [2, 2, 4 - 2 * np.pi]])
    scan = drive.scans[0]
    np.testing.assert_allclose(scan.bearings, np.deg2rad([-90, -45, 0, 45]))
    assert scan.time_s == 12.5
    # the log's largest value and the status codes just below are "no return", zero is "no measurement"
    assert scan.is_return.tolist() == [True, True, False, False]
    assert scan.is_no_return.tolist() == [False, False, True, False]
    assert drive.scans[1].is_no_return.tolist() == [False, False, True, False]


def test_an_odd_number_of_beams_reaches_both_ends_of_the_half_circle(tmp_path):
    line = "FLASER 5 1 1 1 1 9 0 0 0 0 0 0 1 host 1"
    drive = read_carmen(write(tmp_path / "a.log", line))
    np.testing.assert_allclose(np.rad2deg(drive.scans[0].bearings), [-90, -45, 0, 45, 90])


def test_flaser_poses_that_differ_from_odometry_are_the_reference(tmp_path):
    drive = read_carmen(write(tmp_path / "a.log", flaser("1 2 0.5", "3 4 0.1")))
    assert drive.reference is not None
    np.testing.assert_allclose(drive.reference, [[1, 2, 0.5]])
    np.testing.assert_allclose(drive.odometry, [[3, 4, 0.1]])


def test_front_laser_offset_is_the_mount_and_no_reference(tmp_path):
    drive = read_carmen(
        write(tmp_path / "a.log", "PARAM robot_frontlaser_offset 0.5 nohost 0", flaser("1.5 2 0", "1 2 0"))
    )
    assert drive.reference is None
    assert drive.scans[0].T_robot_lidar == (0.5, 0.0, 0.0)
    other = read_carmen(tmp_path / "a.log", T_robot_lidar=(0.78, 0.0, 0.1))
    assert other.scans[0].T_robot_lidar == (0.78, 0.0, 0.1)


@pytest.mark.parametrize("remission", ["0", "3 10 20 30"])
def test_robotlaser_gives_its_own_angles_range_and_mount_also_gzipped(tmp_path, remission):
    line = ROBOT.format(remission=remission, laser="1 2.2 1.5707963", robot="1 2 1.5707963")
    path = tmp_path / "b.clf.gz"
    path.write_bytes(gzip.compress((line + "\nODOM 1 2 3 0 0 0 1 host 1\n").encode()))
    scan = read_carmen(path).scans[0]
    np.testing.assert_allclose(scan.bearings, [-1.0, -0.5, 0.0, 0.5, 1.0])
    np.testing.assert_allclose(scan.T_robot_lidar, [0.2, 0.0, 0.0], atol=1e-6)
    assert scan.is_return.tolist() == [True, False, False, False, True]
    assert scan.is_no_return.tolist() == [False, False, True, True, False]
    assert scan.time_s == 99.5


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("FLASER 4 1.0 2.0", "line 2: FLASER: the line is cut: expected 4 numbers (4 ranges), got 2"),
        ("FLASER 4 1 2 x 4 0 0 0 0 0 0 0 h 0", "line 2: FLASER: expected numbers (4 ranges)"),
        ("FLASER four 1 2", "line 2: FLASER: expected the number of ranges, got 'four'"),
        ("FLASER", "line 2: FLASER: expected the number of ranges, got 'the end of the line'"),
        ("FLASER 1 1 0 0 nan 0 0 0 0 h 0", "line 2: FLASER: expected finite poses"),
        ("ROBOTLASER1 0 -1 2 0.5 8.0", "line 2: ROBOTLASER1: the line is cut: expected 7 numbers"),
        ("ROBOTLASER1 0 -1 2 0.5 -8.0 0 0 1 1 0 0 0 0 0 0 0 0 0 0 0 0 1 h 1", "positive max_range"),
        ("ROBOTLASER1 0 -1 2 -0.5 8.0 0 0 1 1 0 0 0 0 0 0 0 0 0 0 0 0 1 h 1", "positive resolution"),
        ("FLASER 3 1 nan 2 0 0 0 0 0 0 0 h 0", "line 2: FLASER: expected ranges from 0 m on, got nan in beam 2 of 3"),
        ("FLASER 3 1 2 -1 0 0 0 0 0 0 0 h 0", "expected ranges from 0 m on, got -1.0 in beam 3 of 3"),
        ("ROBOTLASER1 0 -1 2 1 8 0 0 2 1 nan 0 0 0 0 0 0 0 0 0 0 0 0 0 1 h 1", "got nan in beam 2 of 2"),
        ("ODOM 1 2 three 0 0 0 0 h 0", "line 2: ODOM: expected numbers (x y theta"),
    ],
)
def test_bad_lines_are_named_by_file_and_number(tmp_path, line, expected):
    path = write(tmp_path / "bad.log", flaser(), line)
    with pytest.raises(InputError) as error:
        read_carmen(path)
    assert expected in str(error.value)
    assert "bad.log" in str(error.value)


def test_unreadable_files_are_errors_that_say_why(tmp_path):
    with pytest.raises(InputError, match="no laser scan found"):
        read_carmen(write(tmp_path / "a.log", "ODOM 1 2 3 0 0 0 0 h 0"))
    with pytest.raises(InputError, match="cannot be read"):
        read_carmen(tmp_path / "missing.log")
    packed = gzip.compress(flaser().encode() * 100)
    (tmp_path / "cut.log.gz").write_bytes(packed[: len(packed) // 2])
    with pytest.raises(InputError, match="gzip stream is cut or broken"):
        read_carmen(tmp_path / "cut.log.gz")
    (tmp_path / "rot.log.gz").write_bytes(packed[:12] + b"\xff\xff\xff" + packed[15:])
    with pytest.raises(InputError, match="gzip stream is cut or broken"):
        read_carmen(tmp_path / "rot.log.gz")


@pytest.mark.skipif("TAGALONG_DATA" not in os.environ, reason="TAGALONG_DATA names no folder of recorded logs")
def test_real_logs_have_the_documented_numbers_of_scans_and_beams():
    logs = Path(os.environ["TAGALONG_DATA"]) / "slam_logs"
    for name, scans, beams, has_reference in (
        ("aces_with_odometry.log.gz", 440, 180, True),
        ("belgioioso_with_odometry.log.gz", 395, 361, True),
        ("intel.gfs.log.gz", 910, 180, False),
        ("orebro-corrected.log.gz", 237, 181, False),
    ):
        drive = read_carmen(logs / name)
        assert (len(drive), len(drive.scans[0])) == (scans, beams)
        assert (drive.reference is not None) == has_reference
