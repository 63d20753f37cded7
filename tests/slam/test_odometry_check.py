"""Grossly wrong odometry is told from its scans: by which factor, and never where the scans cannot tell."""

from dataclasses import replace

import numpy as np
import pytest
from tagalong.slam.drives.odometry_check import OdometryFactors, odometry_factors
from tagalong.slam.geometry import between, compose
from tagalong.slam.logs.drive import RecordedDrive
from walls import cast

WALLS = np.array(
    [
        (-5.0, -3.0, 6.0, -3.0), (6.0, -3.0, 6.0, 1.0), (6.0, 1.0, 3.0, 1.0), (3.0, 1.0, 3.0, 4.0),
        (3.0, 4.0, -1.0, 4.0), (-1.0, 4.0, -1.0, 2.0), (-1.0, 2.0, -5.0, 2.0), (-5.0, 2.0, -5.0, -3.0),
        (-3.0, -0.5, -2.0, -0.3), (1.0, 0.5, 1.6, 0.7),
    ]
)  # fmt: skip
CORRIDOR = np.array([(-60.0, -1.0, 60.0, -1.0), (-60.0, 1.0, 60.0, 1.0)])
MOUNT = (0.25, 0.0, 0.1)


def drive_through(lines, steps, start=(-2.0, -1.8, 0.0), mount=MOUNT):
    rng, poses = np.random.default_rng(0), [np.array(start)]
    for step in steps:
        poses.append(compose(poses[-1], np.array(step)))
    scans = [replace(cast(lines, compose(pose, mount), rng), T_robot_lidar=mount) for pose in poses]
    return RecordedDrive(between(poses[0], np.array(poses)), scans, None, "drive")


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
     (1.0, -1.0, ("radian",)), (-1.0, 1.0, ("metre",)), (0.6, 1.6, ("metre", "radian"))],
)  # fmt: skip
def test_by_which_factor_odometry_is_off_is_told_by_the_scans(tour, forward, turn, complains):
    factors = odometry_factors(told(tour, forward, 1.0, turn))
    assert factors.rotation == pytest.approx(turn, abs=0.03)
    assert factors.translation == pytest.approx(forward, abs=0.15 if turn != 1.0 else 0.05)
    complaint = factors.complaint or ""
    assert complaint.count("\n") == 0
    for unit in ("metre", "radian"):
        assert (f"for each {unit}" in complaint) == (unit in complains)


def test_along_a_smooth_corridor_nothing_is_said_of_metres():
    drive = drive_through(CORRIDOR, [(0.1, 0.0, 0.0)] * 60, (0.0, 0.1, 0.0))
    factors = odometry_factors(told(drive, 3.0))
    assert np.isnan(factors.translation)
    assert factors.complaint is None


def test_a_robot_that_stands_still_or_is_seen_a_few_times_proves_nothing(tour):
    for still in (
        replace(tour, scans=[tour.scans[0]] * len(tour)),
        told(drive_through(WALLS, [(0.1, 0.0, 0.1)] * 5), 3.0),
    ):
        factors = odometry_factors(still)
        assert np.isnan([factors.translation, factors.rotation]).all()
        assert factors.complaint is None
    one = RecordedDrive(tour.odometry[:1], tour.scans[:1], None, "one")
    assert odometry_factors(one).complaint is None


def test_what_is_gross_begins_at_a_fifth_too_little_and_a_quarter_too_much():
    for value, wrong in ((0.79, True), (0.81, False), (1.24, False), (1.26, True)):
        assert (OdometryFactors(value, 1.0, (50, 50)).complaint is not None) == wrong
        assert (OdometryFactors(1.0, value, (50, 50)).complaint is not None) == wrong
