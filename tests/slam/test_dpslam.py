"""DP-SLAM logs: what is read, and one clear error for what cannot be."""

import gzip
import os
from pathlib import Path

import numpy as np
import pytest
from tagalong.slam.drives.log import read_log
from tagalong.slam.engine import make_slam
from tagalong.slam.errors import InputError

LOG = Path(os.environ.get("TAGALONG_DATA", "")) / "slam_logs" / "dpslam_loop5.log.gz"
RANGES = "1.0 2.0 " + "8.191 " * 3 + "0.0 " + "3.0 " * 175
DRIVE = f"Odometry 1.0 2.0 0.5\nLaser 181 {RANGES}\n\nODOMETRY 1.1 2.0 3.5\nLASER 181 {RANGES}\n"


def test_a_log_is_read_with_the_laser_where_the_program_has_it(tmp_path):
    path = tmp_path / "loop.log.gz"
    path.write_bytes(gzip.compress(DRIVE.encode()))
    drive = read_log(path)
    np.testing.assert_allclose(drive.odometry, [[1.0, 2.0, 0.5], [1.1, 2.0, 3.5 - 2.0 * np.pi]])
    scan = drive.scans[1]
    assert scan.T_robot_lidar == (0.4, 0.0, 0.0)
    np.testing.assert_allclose(np.degrees(scan.bearings[[0, 1, -1]]), [-90.0, -89.0, 90.0])
    assert scan.ranges[:2].tolist() == [1.0, 2.0]
    assert np.isinf(scan.ranges[2:5]).all()
    assert np.isnan(scan.ranges[5])
    assert drive.name == "loop"
    assert drive.notes == ("the log has no times",)


def test_a_laser_that_sees_farther_is_known_by_its_farthest_range(tmp_path):
    (tmp_path / "far.log").write_text(DRIVE.replace("8.191", "8.5", 1).replace("2.0 8.191", "2.0 81.9", 1))
    ranges = read_log(tmp_path / "far.log").scans[0].ranges
    assert ranges[2:4].tolist() == [8.5, 8.191]
    assert np.isinf(read_log(tmp_path / "far.log").scans[1].ranges[2])


def test_a_pose_whose_scan_was_cut_off_is_left_out(tmp_path):
    (tmp_path / "cut.log").write_text(DRIVE + "Odometry 1.2 2.0 0.5\n")
    assert len(read_log(tmp_path / "cut.log")) == 2


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("Odometry 1 2\n", ":1: needs x, y and theta"),
        ("Odometry 1 2 nan\n", ":1: needs x, y and theta"),
        ("Odometry 1 2 3\nOdometry 1 2 3\n", ":2: expected a line that begins with Laser, got 'Odometry'"),
        ("Laser 2 1.0 1.0\n", ":1: expected a line that begins with Odometry"),
        ("Odometry 1 2 3\nLaser 3 1.0 2.0\n", ":2: needs the number of beams"),
        ("Odometry 1 2 3\nLaser many 1.0\n", ":2: needs the number of beams"),
        ("Odometry 1 2 3\nLaser 2 1.0 far\n", ":2: expected a range [m], got 'far'"),
        ("Odometry 1 2 3\nLaser 2 1.0 -2.0\n", ":2: ranges must be finite and not negative"),
        ("Odometry 1 2 3\n", ": no laser scan found"),
        ("Odometry 1 2 3\nLaser 2 8.191 8.191\n", ": none of the 1 scans holds a measured distance"),
    ],
)
def test_what_cannot_be_read_is_one_error_with_the_line(tmp_path, text, said):
    (tmp_path / "odd.log").write_text(text)
    with pytest.raises(InputError) as error:
        read_log(tmp_path / "odd.log")
    assert f"odd.log{said}" in str(error.value)


def test_the_published_log_is_read_whole_and_its_scans_fit_on_each_other():
    if not LOG.is_file():
        pytest.skip("needs TAGALONG_DATA with slam_logs/")
    drive = read_log(LOG)
    assert len(drive) == 551
    way = np.hypot(*np.diff(drive.odometry[:, :2], axis=0).T).sum()
    assert way == pytest.approx(56.0, abs=1.0)
    engine = make_slam("cartographer")
    for scan, odometry in zip(drive.scans[:150], drive.odometry[:150], strict=True):
        engine.update(odometry, scan)
    moved = np.hypot(*(engine.trajectory()[-1] - engine.trajectory()[0])[:2])
    by_wheels = np.hypot(*(drive.odometry[149] - drive.odometry[0])[:2])
    assert moved == pytest.approx(by_wheels, abs=0.5)
