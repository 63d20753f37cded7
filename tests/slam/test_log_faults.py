"""Faults put into a drive do what they say, to nothing else, and the same for one seed."""

from dataclasses import replace

import numpy as np
import pytest
from tagalong.slam import LaserScan, RecordedDrive
from tagalong.slam.geometry import between
from tagalong.slam.logs.faults import FAULTS

BEARINGS = np.linspace(-np.pi / 2.0, np.pi / 2.0, 61)


def drive_of(count=120, step_s=0.5):
    """Half a metre ahead and a little to the left from scan to scan, before a wall that comes nearer."""
    headings = 0.01 * np.arange(count)
    places = 0.5 * np.concatenate((np.zeros((1, 2)), np.cumsum(np.stack((np.cos(headings), np.sin(headings)), 1), 0)))
    poses = np.column_stack((places[:count], headings))
    scans = [
        LaserScan(np.where(np.arange(61) < 50, 12.0 - 0.05 * k, np.inf), BEARINGS, 0.1, 30.0, step_s * k)
        for k in range(count)
    ]
    return RecordedDrive(poses, scans, poses + np.array([3.0, 0.0, 0.0]), "straight")


DRIVE = drive_of()


def put(name, drive=DRIVE, seed=0):
    return FAULTS[name].into(drive, np.random.default_rng(seed))


def ranges_of(drive):
    return np.stack([scan.ranges for scan in drive.scans])


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_is_the_same_for_one_seed_and_leaves_the_drive_as_it_was(name):
    before = DRIVE.odometry.tobytes() + ranges_of(DRIVE).tobytes() + DRIVE.times_s.tobytes()
    first, again = put(name), put(name)
    assert DRIVE.odometry.tobytes() + ranges_of(DRIVE).tobytes() + DRIVE.times_s.tobytes() == before
    assert first.recording.odometry.tobytes() == again.recording.odometry.tobytes()
    assert ranges_of(first.recording).tobytes() == ranges_of(again.recording).tobytes()
    np.testing.assert_array_equal(first.recording.reference, DRIVE.reference[first.origin])
    changed = (
        len(first.recording) != len(DRIVE)
        or first.recording.odometry.tobytes() != DRIVE.odometry.tobytes()
        or ranges_of(first.recording).tobytes() != ranges_of(DRIVE).tobytes()
    )
    assert changed == (name != "none")


@pytest.mark.parametrize("name", FAULTS)
def test_a_drive_of_a_few_scans_survives_every_fault(name):
    for count in (2, 5):
        assert len(put(name, drive_of(count)).recording) >= 1


@pytest.mark.parametrize(("name", "scans"), [("frozen-3", 3), ("frozen-5", 5), ("frozen-10", 10)])
def test_frozen_odometry_stands_still_once_in_forty_scans_and_catches_up(name, scans):
    said = put(name).recording.odometry
    still = (np.diff(said, axis=0) == 0.0).all(axis=1)
    assert still.sum() == 3 * scans
    moving = np.concatenate(([True], ~still))
    np.testing.assert_array_equal(said[moving], DRIVE.odometry[moving])


def test_odometry_that_freezes_for_good_never_moves_again():
    said = put("frozen-for-good").recording.odometry
    np.testing.assert_array_equal(said[:41], DRIVE.odometry[:41])
    assert (said[40:] == said[40]).all()


def test_late_odometry_is_that_of_before():
    said = put("late-0.2").recording.odometry
    expected = 0.6 * DRIVE.odometry[10] + 0.4 * DRIVE.odometry[9]  # 0.2 s of a step of 0.5 s
    np.testing.assert_allclose(said[10], expected, atol=1e-9)


def test_a_log_whose_clock_stands_still_is_taken_for_one_scan_a_second():
    stopped = replace(DRIVE, scans=[replace(scan, time_s=7.0) for scan in DRIVE.scans])
    said = put("late-0.1", stopped).recording.odometry
    np.testing.assert_allclose(said[10], 0.9 * DRIVE.odometry[10] + 0.1 * DRIVE.odometry[9], atol=1e-9)


def test_scaled_and_biased_odometry_err_by_the_way():
    true = between(DRIVE.odometry[:-1], DRIVE.odometry[1:])
    longer = put("scale-1.2").recording.odometry
    np.testing.assert_allclose(between(longer[:-1], longer[1:]), true * (1.2, 1.2, 1.0), atol=1e-9)
    turned = put("turn-bias").recording.odometry
    np.testing.assert_allclose(between(turned[:-1], turned[1:]) - true, np.tile((0.0, 0.0, 0.025), (119, 1)), atol=1e-9)


def test_slips_are_few_and_large_and_noise_is_everywhere():
    true = between(DRIVE.odometry[:-1], DRIVE.odometry[1:])
    off = {}
    for name in ("slip", "noise-x10"):
        said = put(name).recording.odometry
        off[name] = np.abs(between(said[:-1], said[1:]) - true).max(axis=1) > 1e-9
    assert 1 <= off["slip"].sum() <= 15
    assert off["noise-x10"].all()


def test_a_stale_scan_has_stamp_and_ranges_of_the_one_before_at_the_odometry_of_now():
    made = put("stale-5").recording
    np.testing.assert_array_equal(made.odometry, DRIVE.odometry)
    for k, scan in enumerate(made.scans):
        shown = k - 1 if k and k % 5 == 0 else k
        assert scan.time_s == DRIVE.scans[shown].time_s
        np.testing.assert_array_equal(scan.ranges, DRIVE.scans[shown].ranges)


def test_scans_are_left_out_doubled_and_turned_round_with_all_that_is_theirs():
    assert put("every-4").origin.tolist() == list(range(0, 120, 4))
    assert put("doubled-5").origin.tolist()[:7] == [0, 0, 1, 2, 3, 4, 5]
    missing = put("gap").origin
    assert len(missing) == 108
    assert np.diff(missing).max() == 13
    back = put("backwards").recording
    np.testing.assert_array_equal(back.odometry, DRIVE.odometry[::-1])
    assert (np.diff(back.times_s) > 0.0).all()


def test_beams_are_dropped_missed_stuck_cut_and_lengthened():
    true = ranges_of(DRIVE)
    assert 0.08 < np.isnan(ranges_of(put("dropped-beams").recording)).mean() < 0.12
    missed = ranges_of(put("missed-beams").recording)[:, :50]
    assert 0.27 < np.isinf(missed).mean() < 0.33
    stuck = ranges_of(put("stuck-beams").recording) == 1.0
    assert (stuck == stuck[0]).all()
    assert 0.05 < stuck[0].mean() < 0.4
    cut = put("reach-8").recording
    assert {scan.range_max for scan in cut.scans} == {8.0}
    assert np.array_equal(np.isinf(ranges_of(cut)), true > 8.0)
    np.testing.assert_allclose(ranges_of(put("range-bias").recording), true + 0.1)


def test_two_people_stand_within_a_metre_on_both_sides():
    for scan in put("people").recording.scans:
        near = scan.ranges < 1.1
        assert near[:25].any()
        assert near[36:].any()
        assert not near[26:35].any()


def test_wheels_err_by_two_factors():
    before, after = (between(d.odometry[:-1], d.odometry[1:]) for d in (DRIVE, put("wheels").recording))
    ratios = after / np.where(before == 0.0, np.nan, before)
    assert ratios[:, 0] == pytest.approx(ratios[0, 0])
    assert ratios[:, 2] == pytest.approx(ratios[0, 2])
    assert 0.5 < ratios[0, 0] < 2.0
    assert 0.5 < ratios[0, 2] < 2.0


def test_a_laser_elsewhere_moves_as_the_robot_that_carries_it_does():
    before, after = (between(d.odometry[:-1], d.odometry[1:]) for d in (DRIVE, put("elsewhere").recording))
    assert after[:, 2] == pytest.approx(before[:, 2])
    assert np.ptp(np.arctan2(after[:, 1], after[:, 0])) < 0.02
    assert np.abs(after[:, :2] - before[:, :2]).max() > 0.01


def test_a_laser_upside_down_sees_what_is_on_its_left_on_its_right():
    assert np.array_equal(ranges_of(put("upside-down").recording), ranges_of(DRIVE)[:, ::-1])


def test_a_simpler_laser_has_some_of_the_beams_where_they_were():
    sparse, narrow = put("sparse-beams").recording, put("narrow-view").recording
    for cut, kept in ((sparse, slice(3, None, 6)), (narrow, slice(15, 46))):
        np.testing.assert_array_equal(cut.scans[5].bearings, BEARINGS[kept])
        np.testing.assert_array_equal(ranges_of(cut), ranges_of(DRIVE)[:, kept])
        assert cut.scans[5].time_s == DRIVE.scans[5].time_s
