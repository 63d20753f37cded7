"""Lasers that measure one beam after the other: when, told by the scans, and scans without the robot's motion."""

import numpy as np
import pytest
from spinning_room import drive_with, off_walls
from tagalong.slam import InputError, LaserScan, RecordedDrive, read_log
from tagalong.slam.drives.made_odometry import with_made_odometry
from tagalong.slam.drives.sweep_time import SweepTime, at_once, deskewed, sweep_time
from tagalong.slam.geometry import between
from tagalong.slam.logs import write_carmen


@pytest.mark.parametrize(
    "time",
    [
        SweepTime(1.0),
        SweepTime(1.0, clockwise=True),
        SweepTime(1.0, ahead=True),
        SweepTime(1.0, clockwise=True, ended=True),
        SweepTime(0.5),
    ],
    ids=str,
)
def test_the_scans_say_when_their_beams_were_measured(time, monkeypatch):
    bent = drive_with(time)
    found = sweep_time(bent)
    assert found == time
    monkeypatch.setattr("tagalong.slam.drives.sweep_time.sweep_time", lambda _: found)  # it takes seconds
    straight = deskewed(bent)
    assert straight.notes[-1].startswith("a turn of the laser, " + ("clockwise" if time.clockwise else "counter"))
    assert off_walls(bent) > 0.1
    assert off_walls(straight) < 0.02


def test_a_laser_that_measures_at_once_is_left_alone():
    drive = drive_with(None)
    assert deskewed(drive) is drive


def test_without_odometry_or_turns_nothing_can_be_told():
    bent = drive_with(SweepTime(1.0))
    blind = RecordedDrive(np.zeros((len(bent), 3)), bent.scans, None, "room", has_odometry=False)
    assert deskewed(blind) is blind
    short = RecordedDrive(bent.odometry[:1], bent.scans[:1], None, "room")
    assert deskewed(short) is short
    still = RecordedDrive(np.zeros((len(bent), 3)), bent.scans, None, "room")
    assert deskewed(still) is still
    empty = [scan.without(np.ones(len(scan), dtype=bool)) for scan in bent.scans]
    assert sweep_time(RecordedDrive(bent.odometry, empty, None, "room")) is None


def test_a_beam_is_put_where_the_robot_was_when_it_was_measured():
    bearings = np.array([-np.pi / 2, 0.0, np.pi / 2])
    scan = LaserScan(np.array([2.0, np.inf, 1.0]), bearings, 0.1, 10.0)
    moved = at_once(scan, np.array([0.4, 0.0, 0.2]), SweepTime(1.0))
    points = moved.beam_points
    assert points[0] == pytest.approx([0.0, -2.0])
    assert points[2] == pytest.approx([0.2 + np.cos(np.pi / 2 + 0.1), np.sin(np.pi / 2 + 0.1)])
    assert moved.ranges[1] == np.inf
    assert moved.bearings[1] == pytest.approx(0.05)


def test_a_laser_before_the_centre_swings_sideways_as_the_robot_turns():
    scan = LaserScan(np.ones(2), np.array([-np.pi / 2, np.pi / 2]), 0.1, 10.0, 0.0, (1.0, 0.0, np.pi / 2))
    moved = at_once(scan, np.array([0.0, 0.0, 0.02]), SweepTime(1.0))  # half of it until the last beam
    # 1 cm to the robot's left, which is ahead of the laser, and 0.01 rad to the left of that
    assert moved.beam_points[1] == pytest.approx([0.01 - 0.01, 1.0], abs=2e-4)


def test_the_first_beam_of_a_clockwise_laser_is_its_last():
    bearings = np.array([-np.pi / 2, 0.0, np.pi / 2])
    scan = LaserScan(np.ones(3), bearings, 0.1, 10.0)
    assert SweepTime(1.0, clockwise=True).of(scan) == pytest.approx([0.5, 0.25, 0.0])
    assert SweepTime(1.0, ended=True).of(scan) == pytest.approx([0.5, 0.25, 0.0])
    assert SweepTime(0.5, ahead=True).of(scan) == pytest.approx([0.375, 0.0, 0.125])


@pytest.mark.parametrize(
    "time", [SweepTime(1.0), SweepTime(0.25, clockwise=True, ended=True), SweepTime(0.5, ahead=True)]
)
def test_words_say_when_beams_are_measured(time):
    assert SweepTime.from_words(time.words) == time
    assert not time.words.split()[-1].replace(".", "").isdigit()  # a command line would take it for a number


@pytest.mark.parametrize(
    "words", ["", "clockwise", "0", "1.5", "nan", "1.0 left", "1.0 ahead ahead", "1 clockwise counter-clockwise"]
)
def test_words_that_say_nothing_of_the_kind_are_told(words):
    with pytest.raises(InputError, match="a laser's sweep is a share"):
        SweepTime.from_words(words)


def test_beams_that_cross_stay_ascending_and_within_limits():
    bearings = np.linspace(-0.1, 0.1, 41)
    ranges = np.where(np.arange(41) % 2, 0.2, 9.999)
    moved = at_once(LaserScan(ranges, bearings, 0.1, 10.0), np.array([0.3, 0.4, 0.0]), SweepTime(1.0))
    assert len(moved) == 41
    assert moved.is_return.all()
    assert (np.diff(moved.bearings) > 0.0).all()


def test_the_way_across_missing_scans_is_that_of_one_and_a_jump_is_none():
    bent = drive_with(SweepTime(1.0))
    poses = bent.odometry.copy()
    poses[40:, 0] += 5.0
    jumped = deskewed(RecordedDrive(poses, bent.scans, None, "room"))
    assert jumped.scans[39] is bent.scans[39]
    kept = np.r_[0:40, 41:80]
    gap = deskewed(RecordedDrive(bent.odometry[kept], [bent.scans[k] for k in kept], None, "room"))
    whole = deskewed(bent)
    turned = gap.scans[39].bearings[-1] - bent.scans[39].bearings[-1]
    assert abs(turned) < 0.6 * abs(bent.odometry[41, 2] - bent.odometry[39, 2]) + 1e-9
    assert np.array_equal(gap.scans[10].ranges, whole.scans[10].ranges)


def test_a_log_is_read_without_the_bend_of_its_scans(tmp_path):
    bent = drive_with(SweepTime(1.0))
    write_carmen(tmp_path / "room.log", bent)
    drive = read_log(tmp_path / "room.log")
    assert "counter-clockwise" in drive.notes[-1]
    assert off_walls(drive) < 0.02


def unmoved(drive):
    return RecordedDrive(np.zeros((len(drive), 3)), drive.scans, None, drive.name, has_odometry=False)


def test_scans_without_odometry_lose_their_bend():
    bent = drive_with(SweepTime(1.0, clockwise=True))
    made, found = with_made_odometry(unmoved(bent))
    assert found.matched.mean() > 0.95
    assert made.notes[-1].startswith("a turn of the laser, clockwise")
    np.testing.assert_array_equal(made.odometry, found.poses)
    error = between(bent.odometry, made.odometry)
    assert np.hypot(error[:, 0], error[:, 1]).max() < 0.1
    assert off_walls(made) < 0.05


def test_scans_measured_at_once_are_left_alone_and_bad_wheels_are_refined():
    drive = drive_with(None)
    made, _ = with_made_odometry(unmoved(drive))
    assert made.scans is drive.scans
    assert off_walls(made) < 0.03
    slipping = RecordedDrive(drive.odometry * (1.2, 1.2, 1.02), drive.scans, None, "room")
    refined, _ = with_made_odometry(slipping, refined=True)
    assert refined.scans is drive.scans
    error = between(drive.odometry, refined.odometry)
    assert np.hypot(error[:, 0], error[:, 1]).max() < 0.05
