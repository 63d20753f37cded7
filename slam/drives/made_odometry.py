"""Drives with odometry made of their scans, or refined by them, and scans without the bend of a slow sweep.

A log without odometry cannot tell how its laser spins; its scans make odometry, bent as they are, and that one can. So
the odometry is made anew of the scans without their bend, and those once more by what that tells.
"""

from dataclasses import replace

from ..logs.drive import RecordedDrive
from ..scan_to_scan.laser_odometry import LaserOdometry, LaserOdometryConfig, laser_odometry
from .sweep_time import deskewed

_ROUNDS = 2  # after these, odometry and scans hardly change any more


def with_made_odometry(
    drive: RecordedDrive, config: LaserOdometryConfig | None = None, *, refined: bool = False
) -> tuple[RecordedDrive, LaserOdometry]:
    """Return the drive with odometry by scan matching, and what scan matching made.

    Where its scans say that the laser measured one beam after the other, the robot's motion meanwhile is taken out of
    them (`deskewed`).

    Args:
        drive: The drive.
        config: Settings.
        refined: Whether its own odometry is refined, else it is not looked at.
    """
    said = drive.odometry if refined else None
    straight, made = drive, laser_odometry(drive.scans, config, said)
    for _ in range(_ROUNDS):
        moved = replace(drive, odometry=made.poses)
        again = deskewed(moved)
        if again is moved:
            break
        straight, made = again, laser_odometry(again.scans, config, said)
    return replace(straight, odometry=made.poses), made
