"""Reads a recorded drive of whatever kind, told by content."""

import os
from pathlib import Path

import numpy as np

from ..errors import InputError
from ..files.input import checked_name, named
from ..logs.bag_messages import is_bag
from ..logs.beesoft import is_beesoft_log, read_beesoft_log
from ..logs.carmen import read_carmen
from ..logs.dpslam import is_dpslam_log, read_dpslam_log
from ..logs.drive import RecordedDrive
from ..logs.rosbag import read_rosbag
from ..logs.urg import is_urg_log, read_urg_log
from .calibration import calibrated
from .sweep_time import deskewed


def read_log(
    path: str | os.PathLike[str], scan_topic: str | None = None, odometry_topic: str | None = None
) -> RecordedDrive:
    """Return the drive in a CARMEN, BeeSoft, DP-SLAM or tinySLAM log (plain or gzipped), a ROS 1 bag or a ROS 2 folder.

    Where its scans say that odometry is grossly wrong, or that the laser stands elsewhere on the robot than the log
    says, that is put right (`calibrated`); where they say that the laser measured one beam after the other, the robot's
    motion meanwhile is taken out of them (`deskewed`). What was done is told in its `notes`.

    Args:
        path: The log.
        scan_topic: Of a bag with several topics of scans, the one to take.
        odometry_topic: Likewise, of odometry.

    Raises:
        InputError: If it cannot be read, or a topic is named for a log that has none.
        MissingExtraError: If it is a bag and `rosbags` is not installed.
    """
    path = Path(path)
    if is_bag(path):
        return _measured(path, read_rosbag(path, scan_topic, odometry_topic))
    if checked_name(path).is_dir():
        raise InputError(f"{named(path)}: a folder without metadata.yaml is no ROS 2 bag")
    if scan_topic is not None or odometry_topic is not None:
        raise InputError(f"{path}: only a ROS bag has topics to choose")
    if is_beesoft_log(path):
        return _measured(path, read_beesoft_log(path))
    if is_dpslam_log(path):
        return _measured(path, read_dpslam_log(path))
    return _measured(path, read_urg_log(path) if is_urg_log(path) else read_carmen(path))


def _measured(path: Path, drive: RecordedDrive) -> RecordedDrive:
    """Return the drive, calibrated, its scans as if measured at once, if any beam of it met anything."""
    if not any(np.isfinite(scan.ranges).any() for scan in drive.scans):
        raise InputError(f"{path}: none of the {len(drive)} scans holds a measured distance; nothing can be mapped")
    return deskewed(calibrated(drive))
