"""Writes a drive as a CARMEN log of `ROBOTLASER1` lines, so that others can run their own SLAM on it."""

import os
from collections.abc import Iterator

import numpy as np

from ..errors import InputError
from ..geometry import compose
from ..scan import LaserScan
from .drive import RecordedDrive
from .text import write_lines

_PLANAR_LASER = 0  # CARMEN's laser_type and remission_mode of a scanner that is not further described
_ACCURACY_M = 0.01


def write_carmen(path: str | os.PathLike[str], drive: RecordedDrive) -> None:
    """Write the scans and the odometry of `drive`; gzipped, equal to the byte for equal drives, where the name ends in
    .gz. Ranges are written in millimetres, 0 for "no measurement", the maximum range for "no return".

    A `ROBOTLASER1` line holds the pose of the laser and that of the robot, so it has no room for `drive.reference`:
    true poses go into a TUM file beside it (see `drive_folder`).

    Raises:
        InputError: If the beams of a scan are not evenly spaced: the format has a first bearing and a step only.
    """
    write_lines(path, _lines(drive))


def _lines(drive: RecordedDrive) -> Iterator[str]:
    yield "# CARMEN log"
    yield (
        "# ROBOTLASER1 laser_type start_angle field_of_view angular_resolution max_range accuracy remission_mode "
        "num_readings [ranges] num_remissions laser_x laser_y laser_theta x y theta tv rv forward_safety_dist "
        "side_safety_dist turn_axis ipc_timestamp host logger_timestamp"
    )
    for number, (pose, scan) in enumerate(zip(drive.odometry, drive.scans, strict=True)):
        step = angular_step(scan, number)
        laser = compose(pose, scan.T_robot_lidar)
        fan = f"{scan.bearings[0]:.9g} {step * (len(scan) - 1):.9g} {step:.9g}"
        poses = " ".join(f"{value:.6f}" for value in (*laser, *pose))
        time = f"{scan.time_s:.6f}"
        yield (
            f"ROBOTLASER1 {_PLANAR_LASER} {fan} {_limit(scan):.12g} {_ACCURACY_M} {_PLANAR_LASER} {len(scan)} "
            f"{_ranges(scan)} 0 {poses} "
            f"0 0 0 0 0 {time} tagalong {time}"
        )


def angular_step(scan: LaserScan, number: int) -> float:
    """Return the angle between neighbouring beams [rad]; `number` names the scan in errors.

    Raises:
        InputError: If there is no one angle, as CARMEN lines and ROS messages need it.
    """
    if len(scan) < 2:
        raise InputError(f"scan {number}: CARMEN and ROS need at least 2 beams, got {len(scan)}")
    steps = np.diff(scan.bearings)
    if np.ptp(steps) > 1e-4:
        raise InputError(
            f"scan {number}: CARMEN and ROS need evenly spaced beams, got steps of {steps.min()} to {steps.max()} rad"
        )
    return float((scan.bearings[-1] - scan.bearings[0]) / (len(scan) - 1))


def _limit(scan: LaserScan) -> float:
    """Return the maximum range in whole millimetres, as ranges are written: what is below it must stay below it."""
    return max(round(scan.range_max, 3), 1e-3)


def _ranges(scan: LaserScan) -> str:
    values = np.zeros(len(scan))
    # a return at the very end of the range must not read as "no return"
    values[scan.is_return] = np.minimum(scan.ranges[scan.is_return], _limit(scan) - 1e-3)
    values[scan.is_no_return] = _limit(scan)
    return " ".join(f"{value:.3f}" for value in values)
