"""Scans of a laser that spins lose the robot's motion as they come."""

from dataclasses import replace

import numpy as np
import pytest
from spinning_room import drive_with, off_walls
from tagalong.slam import Deskewer, InputError, LaserScan
from tagalong.slam.drives import sweep_time
from tagalong.slam.drives.sweep_time import Moment, SweepQuestion, SweepTime


def live(drive, deskewer, later=False):
    """Return the drive as its scans come out, and what was known of the sweep after each.

    Odometry up to the next scan has come with each (`later`), or not.
    """
    scans, known = [], []
    for k, (odometry, scan) in enumerate(zip(drive.odometry, drive.scans, strict=True)):
        after = min(k + 1, len(drive) - 1)
        newest = (drive.scans[after].time_s, drive.odometry[after]) if later else None
        straight, order = deskewer.update(odometry, scan, newest)
        assert sorted(order.tolist()) == list(range(len(scan)))
        assert straight.time_s == scan.time_s
        scans.append(straight)
        known.append(deskewer.sweep)
    return replace(drive, scans=scans), known


def part(drive, first, end=None):
    return replace(drive, odometry=drive.odometry[first:end], scans=drive.scans[first:end])


@pytest.mark.parametrize(
    "time", [SweepTime(1.0), SweepTime(1.0, clockwise=True, ended=True), SweepTime(0.5, ahead=True)], ids=str
)
def test_the_first_turns_say_how_the_laser_spins_and_then_scans_are_straight(time):
    bent = drive_with(time)
    straight, known = live(bent, Deskewer(), later=True)
    assert known[9] is None
    assert known[-1] == time
    begun = known.index(time)
    assert begun < 40
    assert straight.scans[0] is bent.scans[0]
    assert off_walls(part(bent, begun)) > 0.05
    assert off_walls(part(straight, begun, -1)) < 0.02


def test_without_newer_odometry_the_robot_is_taken_to_move_on_as_before():
    bent = drive_with(SweepTime(1.0), swing=0.1)
    straight, _ = live(bent, Deskewer(SweepTime(1.0)))
    assert off_walls(bent) > 0.2
    assert off_walls(straight) < 0.05


def test_newer_odometry_tells_of_the_usual_time_whenever_it_was():
    bent = drive_with(SweepTime(1.0))
    turned = []
    for share in (0.6, 1.0, 1.5):
        deskewer = Deskewer("1.0")
        deskewer.update(bent.odometry[0], bent.scans[0])
        way = np.array([0.0, 0.0, 0.2 * share])
        scan, _ = deskewer.update(bent.odometry[1], bent.scans[1], (0.2 + 0.2 * share, bent.odometry[1] + way))
        turned.append(scan.bearings[-1] - bent.scans[1].bearings[-1])
    assert np.abs(turned).min() > 0.05
    assert np.ptp(turned) < 1e-9


def test_the_pairs_that_turned_most_otherwise_are_the_ones_that_count(monkeypatch):
    """Weak turns say something else here than fast ones, and there are more of them, before and after."""
    scan = drive_with(None, scans=1).scans[0]
    known = SweepQuestion(scan)._candidates

    def says(one, other, times, matcher):
        right = 3 if abs(one.onward[2]) > 0.2 else 5
        return [0.05] + [0.01 if k == right else 0.04 for k in range(len(known))]

    monkeypatch.setattr(sweep_time, "_disagreements", says)
    rng = np.random.default_rng(0)
    turns = np.concatenate((rng.uniform(0.05, 0.1, 100), rng.uniform(0.3, 0.5, 60), rng.uniform(0.05, 0.1, 100)))
    moments = [Moment(scan, np.zeros(3), np.array([0.0, 0.0, turn]), np.zeros(3)) for turn in turns]
    still = Moment(scan, np.zeros(3), np.zeros(3), np.zeros(3))
    question = SweepQuestion(scan)
    for moment in moments:
        question.ask(moment, still)
    assert question.answer == known[3]


def test_odometry_that_is_hardly_newer_and_such_of_a_jump_tell_nothing_of_the_way():
    bent = drive_with(SweepTime(1.0))
    for newest in ((0.25, (0.0, 0.0, 0.5)), (0.4, (5.0, 0.0, 0.0))):
        deskewer = Deskewer(SweepTime(1.0))
        deskewer.update(bent.odometry[0], bent.scans[0])
        scan, _ = deskewer.update(bent.odometry[1], bent.scans[1], newest)
        turned = scan.bearings[-1] - bent.scans[1].bearings[-1]
        assert abs(turned) < 0.1
        assert (turned != 0.0) == (newest[0] == 0.25)


def test_of_a_laser_whose_time_ends_with_the_scan_nothing_is_left_of_the_bend():
    time = SweepTime(1.0, ended=True)
    straight, _ = live(drive_with(time), Deskewer(time))
    assert off_walls(straight) < 0.02


def test_where_it_is_known_how_the_laser_spins_the_first_scans_are_straight_too():
    bent = drive_with(SweepTime(1.0))
    straight, known = live(bent, Deskewer("1.0"), later=True)
    assert set(known) == {SweepTime(1.0)}
    assert off_walls(part(straight, 1, 20)) < 0.02


def test_scans_measured_at_once_stay_as_they_are():
    drive = drive_with(None)
    same, known = live(drive, Deskewer())
    assert set(known) == {None}
    assert all(one is other for one, other in zip(same.scans, drive.scans, strict=True))


def test_a_robot_that_drives_straight_on_and_one_that_sees_nothing_tell_nothing():
    bent = drive_with(SweepTime(1.0))
    ahead = replace(bent, odometry=np.outer(np.arange(len(bent)), (0.1, 0.0, 0.0)))
    assert set(live(ahead, Deskewer())[1]) == {None}
    blind = replace(bent, scans=[scan.without(np.ones(len(scan), dtype=bool)) for scan in bent.scans])
    assert set(live(blind, Deskewer())[1]) == {None}
    empty = replace(bent, scans=[LaserScan([], [], 0.05, 20.0, scan.time_s) for scan in bent.scans])
    assert set(live(empty, Deskewer())[1]) == {None}


def test_the_way_across_missing_scans_is_that_of_one_and_a_jump_is_none():
    bent = drive_with(SweepTime(1.0))
    jumped = bent.odometry.copy()
    jumped[40:, 0] += 5.0
    straight, _ = live(replace(bent, odometry=jumped), Deskewer(SweepTime(1.0)))
    assert straight.scans[40] is bent.scans[40]
    assert straight.scans[41] is not bent.scans[41]
    whole, _ = live(bent, Deskewer(SweepTime(1.0)))
    gap = replace(bent, odometry=np.delete(bent.odometry, 41, axis=0), scans=[*bent.scans[:41], *bent.scans[42:]])
    across = live(gap, Deskewer(SweepTime(1.0)))[0].scans[41]
    turned = [scan.bearings[-1] - bent.scans[42].bearings[-1] for scan in (across, whole.scans[42])]
    steps = bent.odometry[42, 2] - bent.odometry[40, 2], bent.odometry[42, 2] - bent.odometry[41, 2]
    assert turned[0] / turned[1] == pytest.approx(0.5 * steps[0] / steps[1], rel=0.05)


def test_a_pose_that_is_none_and_words_that_say_nothing_are_told():
    with pytest.raises(InputError, match="sweep"):
        Deskewer("round")
    with pytest.raises(InputError, match="pose"):
        Deskewer().update((0.0, np.nan, 0.0), drive_with(None, scans=1).scans[0])
