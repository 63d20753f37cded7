"""Drives among walls, and what a log may say wrong of them."""

from dataclasses import replace

import numpy as np
from tagalong.slam import RecordedDrive
from tagalong.slam.geometry import between, compose, inverse
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


def carried(drive, moved):
    """Return the drive of a robot that is `moved` (3,) from where the log says, by where the laser is."""
    odometry = compose(drive.odometry, inverse(np.array(moved)))
    return replace(drive, odometry=between(odometry[0], odometry))


def upside_down(drive):
    """Return the drive with a laser that hangs upside down."""
    return replace(
        drive, scans=[replace(s, ranges=s.ranges[::-1], bearings=-s.bearings[::-1]) for s in drive.scans]
    )  # fmt: skip


def timed(drive):
    return replace(drive, scans=[replace(scan, time_s=1.0 + 0.1 * k) for k, scan in enumerate(drive.scans)])
