"""Beams as drivers number them, and files as editors leave them, mean the same as anybody's."""

import numpy as np
import pytest
from tagalong.slam.drives.log import read_log
from tagalong.slam.errors import InputError
from tagalong.slam.logs.beams import cut_behind, measured
from tagalong.slam.logs.carmen import read_carmen
from tagalong.slam.logs.carmen_writer import write_carmen
from tagalong.slam.logs.drive import RecordedDrive
from tagalong.slam.logs.ros_map import read_ros_map
from tagalong.slam.logs.scans_npz import read_scans_npz
from tagalong.slam.logs.tum import read_tum
from tagalong.slam.scan import LaserScan

CIRCLE = np.radians(np.arange(0.0, 360.0, 0.5))
LEG, RADIUS = np.array([1.5, 0.0]), 0.06
FLASER = b"FLASER 3 1.0 2.0 3.0 0 0 0 0 0 0 1.0 host 1.0\n"


def ranges_to_a_leg(bearings, yaw=0.0):
    """A leg straight ahead of the robot, a wall 6 m away all around."""
    along, apart = LEG[0] * np.cos(bearings + yaw), LEG[0] * np.sin(bearings + yaw)
    depth = np.sqrt(np.maximum(RADIUS**2 - apart**2, 0.0))
    return np.where((np.abs(apart) < RADIUS) & (along > 0.0), along - depth, 6.0)


def pieces_of_leg(scan):
    """Into how many pieces the order of the beams cuts the leg."""
    on_leg = np.hypot(*(scan.points_robot - LEG).T) < 2.0 * RADIUS
    return int((np.diff(on_leg.astype(int), prepend=0) == 1).sum())


@pytest.mark.parametrize("yaw", [0.0, np.pi, -3.0, 1.0])
def test_a_circle_that_begins_ahead_of_the_robot_is_cut_behind_it(yaw):
    bearings = CIRCLE - yaw
    ranges = ranges_to_a_leg(bearings, yaw)
    cut, turned = cut_behind(ranges, bearings, yaw)
    before = LaserScan(ranges, bearings, 0.1, 8.0, T_robot_lidar=(0.0, 0.0, yaw))
    after = LaserScan(cut, turned, 0.1, 8.0, T_robot_lidar=(0.0, 0.0, yaw))
    assert (np.diff(turned) > 0.0).all()
    assert abs(np.cos(turned[0] + yaw) + 1.0) < 1e-3
    order = np.lexsort(np.round(after.points_robot, 9).T)
    np.testing.assert_allclose(
        after.points_robot[order], before.points_robot[np.lexsort(np.round(before.points_robot, 9).T)], atol=1e-9
    )
    assert [pieces_of_leg(before), pieces_of_leg(after)] == [2, 1]


@pytest.mark.parametrize("count", [361, 370])
def test_a_circle_that_ends_beyond_its_beginning_has_each_direction_once(count):
    bearings = np.radians(np.arange(float(count)))
    cut, turned = cut_behind(np.arange(float(count)), bearings)
    assert sorted(cut.tolist()) == list(range(360))
    np.testing.assert_allclose(np.diff(turned), np.radians(1.0), atol=1e-9)
    assert len(LaserScan(cut, turned, 0.0, 400.0).points) == 360


@pytest.mark.parametrize(
    ("bearings", "yaw"),
    [
        (CIRCLE - np.pi, 0.0),  # cut behind already
        (CIRCLE - 3.0, 0.1),  # nearly so
        (np.radians(np.arange(0.0, 270.0)), 0.0),  # no circle: it would be cut in its middle
        (np.array([0.0]), 0.0),
        (np.zeros(0), 0.0),
    ],
)
def test_other_sweeps_stay_as_they_are(bearings, yaw):
    ranges = np.arange(float(len(bearings)))
    for ours, theirs in zip(cut_behind(ranges, bearings, yaw), (ranges, bearings), strict=True):
        np.testing.assert_array_equal(ours, theirs)


def test_zero_is_no_measurement_where_the_limit_does_not_say_so():
    np.testing.assert_array_equal(measured(np.array([0.0, 1.0, np.inf, np.nan])), [np.nan, 1.0, np.inf, np.nan])
    np.testing.assert_array_equal(measured(np.array([0.0, 1.0]), 0.05), [0.0, 1.0])
    assert LaserScan(measured(np.array([0.0, 1.0])), np.arange(2.0), 0.0, 5.0).is_return.tolist() == [False, True]


def test_arrays_of_a_driver_that_counts_from_zero_are_cut_behind_and_know_no_return_at_the_laser(tmp_path):
    ranges = ranges_to_a_leg(CIRCLE)
    ranges[100] = 0.0
    step = CIRCLE[1]
    np.savez(tmp_path / "s.npz", ranges=[ranges], angle_min=0.0, angle_increment=step, range_min=0.0, range_max=8.0)
    scan = read_scans_npz(tmp_path / "s.npz")[0]
    assert int(scan.is_return.sum()) == len(CIRCLE) - 1
    assert pieces_of_leg(scan) == 1


def test_a_carmen_circle_from_zero_on_is_cut_behind(tmp_path):
    words = " ".join(f"{r:.4f}" for r in ranges_to_a_leg(CIRCLE))
    line = f"ROBOTLASER1 0 0 {CIRCLE[-1]} {CIRCLE[1]} 20 0 0 {len(CIRCLE)} {words} 0 0 0 0 0 0 0 0 0 0 0 0 1 h 1\n"
    (tmp_path / "a.log").write_text(line)
    scan = read_carmen(tmp_path / "a.log").scans[0]
    assert scan.bearings[0] == pytest.approx(-np.pi)
    assert pieces_of_leg(scan) == 1


def test_a_scan_has_a_finite_limit():
    with pytest.raises(InputError, match="`range_max` <= 100000"):
        LaserScan(np.ones(3), np.arange(3.0), 0.0, np.inf)


@pytest.mark.parametrize("limit", [30.0, 81.50045, 81.4996, 5.0005, 12345.6789])
def test_returns_and_no_returns_keep_apart_in_a_written_log_whatever_the_limit(tmp_path, limit):
    scan = LaserScan(np.array([1.0, np.inf, limit, limit - 2e-4, np.nan]), np.linspace(-1.0, 1.0, 5), 0.0, limit)
    write_carmen(tmp_path / "a.log", RecordedDrive(np.zeros((1, 3)), [scan], None, "a"))
    back = read_carmen(tmp_path / "a.log").scans[0]
    np.testing.assert_array_equal(back.is_return, scan.is_return)
    np.testing.assert_array_equal(back.is_no_return, scan.is_no_return)
    np.testing.assert_allclose(back.ranges[back.is_return], scan.ranges[scan.is_return], atol=2e-3)


def test_a_comment_in_latin_1_does_not_hide_a_log(tmp_path):
    (tmp_path / "a.log").write_bytes("# Universität Freiburg\n".encode("latin-1") + FLASER)
    assert len(read_log(tmp_path / "a.log")) == 1


def test_the_mark_that_editors_put_first_is_no_part_of_a_file(tmp_path):
    mark = b"\xef\xbb\xbf"
    (tmp_path / "a.log").write_bytes(mark + FLASER + FLASER)
    assert len(read_log(tmp_path / "a.log")) == 2
    (tmp_path / "a.tum").write_bytes(mark + b"0 1 2 0 0 0 0 1\r\n1 1 2 0 0 0 0 1\r\n")
    assert len(read_tum(tmp_path / "a.tum")) == 2
    (tmp_path / "m.pgm").write_bytes(b"P5\r\n2 1\r\n255\n\x00\xfe")
    entries = (
        "image: m.pgm\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    (tmp_path / "m.yaml").write_bytes(mark + entries.replace("\n", "\r\n").encode())
    assert read_ros_map(tmp_path / "m.yaml").probability.tolist() == [[1.0, 0.0]]


def test_a_circle_whose_last_beam_is_the_first_again_keeps_one_of_them():
    bearings = 2.0 * np.pi / 359 * np.arange(360)
    cut, turned = cut_behind(np.arange(1.0, 361.0), bearings)
    assert (np.diff(turned) > 0.0).all()
    assert len(cut) == len(turned) == 359
    assert np.count_nonzero(np.isin(cut, [1.0, 360.0])) == 1
