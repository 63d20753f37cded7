"""A bag is put right as its scans come, as it is when it is read whole."""

from dataclasses import replace

import numpy as np
import pytest
from spinning_room import drive_with
from tagalong.scripts.cli import main
from tagalong.slam import LaserScan, RecordedDrive, read_log
from tagalong.slam.drives import scan_correction
from tagalong.slam.drives.scan_correction import ScanCorrection, surveyed_bag
from tagalong.slam.drives.sweep_time import SweepTime, straightened
from tagalong.slam.logs.bag_messages import open_bag
from tagalong.slam.logs.bag_writer import write_rosbag
from tagalong.slam.logs.scan_stream import ReadAlready, ScanStream, StreamedScan, read_beginning
from walled_drives import WALLS, carried, drive_through, timed, upside_down


def corrected_stream(path):
    """Return the beginning of a bag, and its scans."""
    bag, correction = surveyed_bag(read_beginning(path))
    stream, scans = ScanStream(replace(bag, types=ReadAlready())), []
    with open_bag(path) as opened:
        for topic, recorded_s, content in opened.with_topics(bag.scans, bag.odometry):
            for streamed in stream.take(topic, bag.topics[topic], round(1e9 * recorded_s), content):
                scans += correction.take(streamed)
        for streamed in stream.rest():
            scans += correction.take(streamed)
    return bag, [*scans, *correction.rest()]


@pytest.fixture(scope="module")
def tour():
    return drive_through(WALLS, ([(0.1, 0.0, 0.0)] * 15 + [(0.02, 0.0, 0.1)] * 10) * 4)


def test_a_bag_is_calibrated_by_its_first_moves(tour, tmp_path):
    path = tmp_path / "wrong.bag"
    write_rosbag(path, timed(upside_down(carried(tour, (0.0, 0.0, np.pi)))))
    bag, scans = corrected_stream(path)
    assert bag.flipped
    assert len(bag.notes) == 2
    odometry = np.array([one.odometry for one in scans])
    assert np.abs(odometry[:, :2] - tour.odometry[:, :2]).max() < 0.2
    np.testing.assert_allclose(scans[7].scan.ranges, tour.scans[7].ranges, rtol=1e-6)


def test_a_bag_that_is_right_and_one_without_odometry_stay_as_they_are(tour, tmp_path):
    write_rosbag(tmp_path / "right.bag", timed(tour))
    bag, scans = corrected_stream(tmp_path / "right.bag")
    assert not bag.notes
    assert np.array([one.odometry for one in scans]) == pytest.approx(tour.odometry, abs=1e-9)
    without = replace(bag, odometry="", moving=None)
    assert surveyed_bag(without)[0] is without


def test_the_people_filter_takes_no_wall_for_people_where_a_bag_is_wrong_about_its_laser(tour, tmp_path, capsys):
    """By that odometry the walls walk."""
    write_rosbag(tmp_path / "wrong.bag", timed(carried(tour, (0.0, 0.0, np.pi))))
    assert main(["filter", str(tmp_path / "wrong.bag"), str(tmp_path / "out.bag"), "--quiet"]) == 0
    said = capsys.readouterr()
    assert "the laser does not stand" in said.err
    assert "101 scans, 0 people, 0.00 % of returns removed" in said.out


def test_a_laser_that_is_said_to_hang_upside_down_and_does_not_is_turned_back(tour, tmp_path):
    write_rosbag(tmp_path / "right.bag", timed(tour))
    bag, _ = surveyed_bag(replace(read_beginning(tmp_path / "right.bag"), flipped=True))
    assert not bag.flipped
    assert len(bag.notes) == 1


def test_a_robot_that_stands_first_is_looked_at_when_it_moves(tour, tmp_path, monkeypatch):
    monkeypatch.setattr(scan_correction, "_MOST_SCANS", 80)
    wrong = carried(tour, (0.0, 0.0, np.pi))
    standing = RecordedDrive(
        np.concatenate((np.repeat(wrong.odometry[:1], 90, axis=0), wrong.odometry)),
        [replace(wrong.scans[0]) for _ in range(90)] + wrong.scans, None, "standing",
    )  # fmt: skip
    write_rosbag(tmp_path / "wrong.bag", timed(standing))
    assert "the laser does not stand" in surveyed_bag(read_beginning(tmp_path / "wrong.bag"))[0].notes[0]


def test_beams_that_cross_are_still_those_of_their_readings():
    bearings = np.linspace(-0.1, 0.1, 41)
    ranges = np.where(np.arange(41) % 2, 0.2, 9.999)
    correction, way = ScanCorrection(sweep=SweepTime(1.0), usual_s=0.1), np.array([0.3, 0.3, 0.0])
    scans = [
        StreamedScan(None, 0, LaserScan(ranges, bearings, 0.1, 10.0, 0.1 * k), np.arange(41)[::-1], k * way)
        for k in range(2)
    ]
    assert not list(correction.take(scans[0]))
    (straight,) = correction.take(scans[1])
    scan, order = straightened(scans[0].scan, way, SweepTime(1.0))
    assert (np.diff(order) < 0).any()
    assert np.array_equal(straight.order, 40 - order)
    assert np.array_equal(straight.scan.ranges, scan.ranges)


@pytest.mark.parametrize("command", ["slam", "perceive"])
def test_commands_say_what_they_put_right(tour, tmp_path, command, capsys):
    write_rosbag(tmp_path / "wrong.bag", timed(carried(tour, (0.0, 0.0, np.pi))))
    assert main([command, str(tmp_path / "wrong.bag"), "--out", str(tmp_path / "out"), "--quiet"]) == 0
    assert capsys.readouterr().err.count("wrong.bag: the laser does not stand") == 1


@pytest.mark.parametrize("time", [SweepTime(1.0), SweepTime(1.0, clockwise=True, ended=True)])
def test_the_scans_of_a_bag_lose_their_bend_as_they_come_as_they_do_when_it_is_read(tmp_path, time):
    path, bent = tmp_path / "room.bag", drive_with(time)
    write_rosbag(path, bent)
    bag, scans = corrected_stream(path)
    read = read_log(path)
    assert bag.notes == read.notes
    assert len(scans) == len(read)
    for one, scan in zip(scans, read.scans, strict=True):
        np.testing.assert_allclose(one.scan.bearings, scan.bearings, atol=1e-6)
        np.testing.assert_allclose(one.scan.ranges, scan.ranges, atol=1e-6)
        assert one.scan.time_s == scan.time_s
        assert sorted(one.order.tolist()) == list(range(len(scan)))
        assert np.median(np.abs(one.message.ranges[one.order] - scan.ranges)) < 0.1
