"""Scans tell where the laser stands and what odometry makes of a metre and a turn, and never more than they show."""

from dataclasses import replace

import numpy as np
import pytest
from tagalong.slam.drives.calibration import _slope, calibrated, calibration
from tagalong.slam.drives.log import read_log
from tagalong.slam.geometry import between, compose, inverse, wrap_angle
from tagalong.slam.logs.carmen_writer import write_carmen
from tagalong.slam.logs.drive import RecordedDrive
from walled_drives import CORRIDOR, MOUNT, WALLS, carried, drive_through, upside_down


def told(drive, forward=1.0, aside=1.0, turn=1.0):
    """Return the drive as odometry tells it whose motions are off by factors."""
    steps = between(drive.odometry[:-1], drive.odometry[1:]) * [forward, aside, turn]
    poses = [np.zeros(3)]
    for step in steps:
        poses.append(compose(poses[-1], step))
    return replace(drive, odometry=np.array(poses))


@pytest.fixture(scope="module")
def tour():
    return drive_through(WALLS, ([(0.1, 0.0, 0.0)] * 15 + [(0.02, 0.0, 0.1)] * 10) * 4)


@pytest.mark.parametrize(
    ("forward", "turn", "complains"),
    [(1.0, 1.0, ()), (1.15, 0.9, ()), (1.5, 1.0, ("metre",)), (1.0, 0.5, ("radian",)), (0.0, 0.0, ("metre", "radian")),
     (0.6, 1.6, ("metre", "radian"))],
)  # fmt: skip
def test_by_which_factor_odometry_is_off_is_told_by_the_scans(tour, forward, turn, complains):
    wrong = told(tour, forward, 1.0, turn)
    found, mended = calibration(wrong), calibrated(wrong)
    assert found.turn == pytest.approx(turn, abs=0.03)
    assert found.way == pytest.approx(forward, abs=0.15 if turn != 1.0 else 0.05)
    assert len(mended.notes) == bool(complains)
    for unit in ("metre", "radian"):
        assert (f"for each {unit}" in "".join(mended.notes)) == (unit in complains)
    if forward == 0.0:
        assert "may be wrong" in mended.notes[0]
    assert (mended is wrong) == (not complains)
    assert (mended.odometry is wrong.odometry) == (not complains or forward == 0.0)


def test_odometry_that_is_put_right_leads_where_the_robot_went(tour):
    off = [np.abs(calibrated(told(tour, *how)).odometry - tour.odometry) for how in ((2.0, 2.0), (1.0, 1.0, 0.6))]
    assert max(o[:, :2].max() for o in off) < 0.3
    assert max(np.abs(wrap_angle(o[:, 2])).max() for o in off) < 0.2


@pytest.mark.parametrize("moved", [(0.0, 0.0, np.pi), (0.0, 0.0, 0.5), (0.6, 0.0, 0.0), (-0.2, 0.3, -np.pi / 2.0)])
@pytest.mark.parametrize("flipped", [False, True])
def test_where_the_laser_stands_is_told_by_odometry_and_scans(tour, moved, flipped):
    """The poses stay those of the robot that the log means, at whose laser the scans are."""
    wrong = carried(tour, moved)
    wrong = upside_down(wrong) if flipped else wrong
    if flipped:  # the robot that the log means is where its laser, turned over, says
        mount = np.array(MOUNT)
        moved = compose(np.array(moved), compose(mount, inverse(mount)))
    found, mended = calibration(wrong), calibrated(wrong)
    assert found.mirrored == flipped
    assert found.moved[:2] == pytest.approx(moved[:2], abs=0.05)
    assert wrap_angle(found.moved[2] - moved[2]) == pytest.approx(0.0, abs=0.05)
    assert len(mended.notes) == 1 + flipped
    off = mended.odometry - tour.odometry
    assert np.abs(off[:, :2]).max() < 0.2
    assert np.abs(wrap_angle(off[:, 2])).max() < 0.1
    assert np.array_equal(mended.scans[7].ranges, tour.scans[7].ranges)
    assert mended.scans[7].T_robot_lidar == MOUNT


def test_the_note_says_where_the_laser_stands(tour):
    notes = calibrated(carried(tour, (0.5, -0.1, np.pi))).notes
    assert len(notes) == 1
    assert "0.25 m ahead and -0.1" in notes[0]
    assert "-174 degrees" in notes[0]


def test_along_a_smooth_corridor_nothing_is_said_of_metres():
    drive = drive_through(CORRIDOR, [(0.1, 0.0, 0.0)] * 60, (0.0, 0.1, 0.0))
    wrong = told(drive, 3.0)
    assert np.isnan(calibration(wrong).way)
    assert calibrated(wrong) is wrong


def test_without_turns_nothing_is_said_of_where_the_laser_stands_but_how_it_is_turned():
    straight = drive_through(WALLS, [(0.1, 0.0, 0.0)] * 40)
    found = calibration(carried(straight, (0.6, 0.2, 1.0)))
    assert np.isnan(found.turn)
    assert found.moved == pytest.approx((0.0, 0.0, 1.0), abs=0.05)


def test_wheels_that_slip_now_and_then_change_nothing(tour):
    """Every third pair or so spans a slip of half a metre and a radian, all to one side."""
    steps = between(tour.odometry[:-1], tour.odometry[1:])
    steps[::10] = compose(steps[::10], (0.5, 0.3, 1.0))
    poses = [np.zeros(3)]
    for step in steps:
        poses.append(compose(poses[-1], step))
    found = calibration(carried(replace(tour, odometry=np.array(poses)), (0.0, 0.0, np.pi)))
    assert (found.way, found.turn) == pytest.approx((1.0, 1.0), abs=0.1)
    assert abs(wrap_angle(found.moved[2] - np.pi)) < 0.1
    assert np.hypot(*found.moved[:2]) < 0.1


def test_the_usual_ratio_of_turns_counts_in_whatever_order_they_come():
    seen, told = np.full(21, 0.3), np.full(21, 0.3)
    told[8:13] = 1.2  # in the middle of the drive
    assert _slope(told, seen) == pytest.approx(1.0)


def test_a_few_turns_do_not_say_where_the_laser_stands():
    """Nor whether it hangs upside down; a mirrored one seems to stand elsewhere then."""
    few = drive_through(WALLS, [(0.1, 0.0, 0.0)] * 15 + [(0.05, 0.0, 0.15)] * 4 + [(0.1, 0.0, 0.0)] * 15)
    found = calibration(upside_down(carried(few, (0.6, 0.0, 0.0))))
    assert np.isnan(found.turn)
    assert found.moved[:2] == (0.0, 0.0)


def test_a_robot_that_stands_still_or_is_seen_a_few_times_proves_nothing(tour):
    for still in (
        replace(tour, scans=[tour.scans[0]] * len(tour)),
        told(drive_through(WALLS, [(0.1, 0.0, 0.1)] * 5), 3.0),
        RecordedDrive(tour.odometry[:1], tour.scans[:1], None, "one"),
        RecordedDrive(tour.odometry[:0], [], None, "none"),
    ):
        found = calibration(still)
        assert np.isnan([found.way, found.turn]).all()
        assert calibrated(still) is still


def test_matches_that_do_not_agree_prove_nothing(tour):
    """Odometry of another drive has nothing to do with these scans."""
    rng = np.random.default_rng(1)
    steps = rng.normal(0.0, (0.15, 0.15, 0.3), (len(tour), 3))
    poses = [np.zeros(3)]
    for step in steps[:-1]:
        poses.append(compose(poses[-1], step))
    found = calibration(replace(tour, odometry=np.array(poses)))
    assert np.isnan(found.way)
    assert found.moved == (0.0, 0.0, 0.0)


def test_what_is_gross_begins_at_a_fifth_too_little_and_a_quarter_too_much(tour):
    right = calibration(tour)
    for value, wrong in ((0.79, True), (0.81, False), (1.24, False), (1.26, True)):
        assert bool(replace(right, way=value).wrong_factors) == wrong
        assert bool(replace(right, turn=value).wrong_factors) == wrong
    for moved, wrong in (
        ((0.2, 0.1, 0.0), False),
        ((0.2, 0.2, 0.0), True),
        ((0, 0, -0.19), False),
        ((0, 0, 0.21), True),
    ):
        assert replace(right, moved=moved).misplaced == wrong


def test_without_odometry_there_is_nothing_to_calibrate(tour):
    without = replace(tour, odometry=np.zeros((len(tour), 3)), has_odometry=False)
    assert calibrated(without) is without


def test_a_log_is_read_calibrated(tour, tmp_path):
    write_carmen(tmp_path / "wrong.log", carried(tour, (0.0, 0.0, np.pi)))
    read = read_log(tmp_path / "wrong.log")
    assert any("the laser does not stand" in note for note in read.notes)
    assert np.abs(read.odometry[:, :2] - tour.odometry[:, :2]).max() < 0.25
