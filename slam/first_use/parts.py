"""What is compiled together at the first use: each function runs a part of SLAM on a short drive round a room."""

import numpy as np

from ..drives.calibration import calibrated
from ..drives.made_odometry import with_made_odometry
from ..drives.sweep_time import deskewed
from ..engine import make_slam
from ..logs.drive import RecordedDrive
from ..runner import run_slam
from ..scan import LaserScan
from ..scan_to_scan.laser_odometry import LaserOdometryConfig


def correct_drive() -> None:
    """Look for what is wrong with the odometry and the laser of a log, and match scans with scans."""
    drive = deskewed(calibrated(round_the_room()))
    with_made_odometry(drive, LaserOdometryConfig(), refined=True)


def map_by_particles() -> None:
    """Map by GMapping."""
    run_slam(make_slam("gmapping", particles=3, seed=0), round_the_room()).map()


def map_by_graph() -> None:
    """Map by graph SLAM."""
    run_slam(make_slam("cartographer", seed=0), round_the_room()).map()


def round_the_room(scans: int = 80) -> RecordedDrive:
    """Return a drive of two laps in a room of 8 x 6 m."""
    angles = np.linspace(0.0, 4.0 * np.pi, scans)
    poses = np.stack((1.5 * np.sin(angles), -1.5 * np.cos(angles), angles), axis=-1)
    bearings = np.linspace(-np.pi, np.pi, 180, endpoint=False)
    taken = []
    for i, (x, y, theta) in enumerate(poses.tolist()):
        cos, sin = np.cos(bearings + theta), np.sin(bearings + theta)
        to_walls = np.minimum((4.0 * np.sign(cos) - x) / _not_0(cos), (3.0 * np.sign(sin) - y) / _not_0(sin))
        taken.append(LaserScan(to_walls, bearings, range_min=0.05, range_max=30.0, time_s=0.2 * i))
    return RecordedDrive(poses, taken, None, "room")


def _not_0(values: np.ndarray) -> np.ndarray:
    return np.where(np.abs(values) < 1e-9, 1e-9, values)
