"""Nodes of ROS 2 take the robot's motion out of the scans of a laser that spins."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from spinning_room import MOUNT, drive_with, off_walls
from tagalong.scripts.ros import filter_logic, live_scans, outputs, slam_logic
from tagalong.slam import LaserScan, SlamUpdate

pytest.importorskip("rosbags.highlevel")


@pytest.fixture
def make():
    return outputs.RosMessages()


SWEEP = "1 clockwise ended"


def play_room(make, logic):
    """What a node sends for turns in a room with a laser that spins as `SWEEP` says, and what it tells."""
    drive, sent, told = drive_with(live_scans.InputConfig(sweep=SWEEP).deskewer().sweep), [], []
    logic.take("/tf_static", make.transform(MOUNT, 0.0, ("base_link", "laser")), 0.0)
    for pose, scan in zip(drive.odometry, drive.scans, strict=True):
        logic.take("odom", make.odometry(pose, np.zeros(3), scan.time_s, ("odom", "base_link")), scan.time_s)
        sent.append(logic.take("scan", make.scan(scan, scan.time_s, "laser"), scan.time_s))
        told += logic.notes()
    return drive, sent, told


def test_the_motion_of_a_spinning_laser_is_taken_out_once_its_turns_have_shown_it_and_said_once(make):
    _, sent, told = play_room(make, filter_logic.FilterLogic(make, filter_logic.FilterNodeConfig()))
    assert told[-1].startswith("a turn of the laser, clockwise")
    assert told[-1].endswith(f"with sweep:='{SWEEP}'")
    assert len(told) == len(set(told))
    assert [len(outputs) for outputs in sent] == [4] * len(sent)


def test_odometry_that_came_before_the_scan_tells_how_the_robot_moved_in_its_sweep(make):
    config = live_scans.InputConfig(sweep="1.0")
    drive, scans, live = drive_with(config.deskewer().sweep), live_scans.LiveScans(config), []
    scans.take("/tf_static", make.transform(MOUNT, 0.0, ("base_link", "laser")), 0.0)
    for k, scan in enumerate(drive.scans):
        now_s = scan.time_s + 0.2
        for j in (0, 1) if k == 0 else (k + 1,):
            if j < len(drive):
                odometry = make.odometry(drive.odometry[j], np.zeros(3), drive.scans[j].time_s, ("odom", "base_link"))
                scans.take("odom", odometry, now_s)
        live += scans.take("scan", make.scan(scan, scan.time_s, "laser"), now_s)
    straight = replace(drive, scans=[one.scan for one in live[:-1]], odometry=drive.odometry[:-1])
    assert off_walls(straight) < 0.02
    for one, scan in zip(live, drive.scans, strict=True):
        assert np.median(np.abs(one.message.ranges[one.order] - one.scan.ranges)) < 0.05
        assert sorted(one.order.tolist()) == list(range(len(scan)))


def test_beams_that_cross_are_still_those_of_their_readings(make):
    scans, ranges = live_scans.LiveScans(live_scans.InputConfig(sweep="1.0")), np.where(np.arange(41) % 2, 0.2, 9.0)
    scans.take("/tf_static", make.transform((0.0, 0.0, 0.0), 0.0, ("base_link", "laser")), 0.0)
    for k in range(2):
        pose, scan = (0.3 * k, 0.3 * k, 0.0), LaserScan(ranges, np.linspace(-0.1, 0.1, 41), 0.1, 10.0, 0.1 * k)
        scans.take("odom", make.odometry(pose, np.zeros(3), 0.1 * k, ("odom", "base_link")), 0.1 * k)
        (live,) = scans.take("scan", make.scan(scan, 0.1 * k, "laser"), 0.1 * k)
    assert (np.diff(live.order) < 0).any()
    assert np.abs(live.message.ranges[live.order] - live.scan.ranges).max() < 0.1


@pytest.mark.parametrize(("sweep", "straight"), [(SWEEP, True), ("at-once", False)])
def test_how_a_laser_spins_can_be_told(make, sweep, straight):
    seen = []
    config = slam_logic.SlamNodeConfig(method="gmapping", filter_people=False, sweep=sweep, map_every_s=1e6)
    logic = slam_logic.SlamLogic(make, config)
    logic._engine = SimpleNamespace(
        update=lambda odometry, scan: seen.append(scan) or SlamUpdate(odometry, True, {}),
        live_map=logic._engine.live_map,
    )
    drive, _, told = play_room(make, logic)
    assert told == []
    assert (off_walls(replace(drive, scans=seen)) < 0.03) == straight
