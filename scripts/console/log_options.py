"""Options of commands that read recorded drives, and the reading itself."""

import argparse
import sys
from dataclasses import replace
from pathlib import Path

from ...slam.logs.drive import RecordedDrive
from ...slam.logs.log import read_log
from ...slam.scan_to_scan.laser_odometry import laser_odometry
from ...slam.scan_to_scan.odometry_check import odometry_factors


def add_topics(parser: argparse.ArgumentParser) -> None:
    """Declare the options that choose the topics of a ROS bag."""
    parser.add_argument("--scan-topic", metavar="NAME", help="of a ROS bag with several topics of laser scans")
    parser.add_argument("--odometry-topic", metavar="NAME", help="of a ROS bag with several topics of odometry")


def read_with_odometry(path: Path, scan_topic: str | None, odometry_topic: str | None) -> RecordedDrive:
    """Return the drive in a log; where it has no odometry, with one made from its scans.

    What was assumed is said on stderr, and once in a line if the odometry is grossly wrong by what the scans show.

    Args:
        path: CARMEN, BeeSoft, DP-SLAM or tinySLAM log, or ROS bag.
        scan_topic: Of a bag, the topic of the scans; None: the only one.
        odometry_topic: Of a bag, the topic of the odometry; None: the only one.
    """
    drive = read_log(path, scan_topic, odometry_topic)
    for note in drive.notes:
        print(f"tagalong: {path}: {note}", file=sys.stderr)
    if drive.has_odometry:
        complaint = odometry_factors(drive).complaint
        if complaint:
            print(f"tagalong: {path}: {complaint}; poses may be wrong", file=sys.stderr)
        return drive
    made = laser_odometry(drive.scans)
    lost = int((~made.matched).sum())
    said = f"odometry is made from the scans; {lost} of {len(drive)} could not be matched with one before"
    print(f"tagalong: {said}", file=sys.stderr)
    return replace(drive, odometry=made.poses)
