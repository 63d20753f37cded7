"""Drives written as ROS bags, read again."""

import numpy as np
import pytest
from tagalong.slam import InputError, LaserScan, RecordedDrive, read_log
from tagalong.slam.geometry import between

pytest.importorskip("rosbags")
from tagalong.slam.logs.bag_writer import write_rosbag


def test_a_drive_comes_back_from_a_bag_as_it_was(tmp_path):
    bearings, times = np.linspace(-1.0, 1.0, 5), 10.0 + 0.1 * np.arange(4)
    ranges = np.array([1.0, 2.5, np.inf, np.nan, 7.9])
    scans = [LaserScan(ranges, bearings, 0.1, 8.0, float(t), (0.2, 0.0, 0.1)) for t in times]
    odometry = np.stack((0.3 * np.arange(4), 0.1 * np.arange(4), 0.2 * np.arange(4)), axis=-1)
    write_rosbag(tmp_path / "drive.bag", RecordedDrive(odometry, scans, None, "drive"))
    back = read_log(tmp_path / "drive.bag")
    np.testing.assert_allclose(between(odometry, back.odometry), 0.0, atol=1e-9)
    np.testing.assert_allclose(back.times_s, times)
    assert back.scans[0].T_robot_lidar == pytest.approx((0.2, 0.0, 0.1))
    np.testing.assert_allclose(back.scans[0].bearings, bearings, atol=1e-7)
    np.testing.assert_allclose(back.scans[0].ranges, ranges.astype(np.float32))
    assert back.notes == ()


def test_beams_that_are_not_evenly_spaced_fit_into_no_message(tmp_path):
    scan = LaserScan(np.ones(3), np.array([0.0, 0.1, 0.3]), 0.1, 8.0)
    with pytest.raises(InputError, match="scan 0: CARMEN and ROS need evenly spaced beams"):
        write_rosbag(tmp_path / "drive.bag", RecordedDrive(np.zeros((1, 3)), [scan], None, "drive"))
    assert list(tmp_path.iterdir()) == []
