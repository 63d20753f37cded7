"""Reads logs of DP-SLAM (Eliazar, Parr 2004; Duke University), as its README describes them.

Two lines a scan, the pose at the scan first; capital letters or not, and no times:
    Odometry x y theta    [m, m, rad]
    Laser n r1..rn        ranges [m] from 90 degrees to the right on, one degree apart, to the left
The laser stands 0.40 m ahead of the centre of the wheels (`TURN_RADIUS` of the program, an ATRV Jr.). A SICK that
measures up to 8 m writes up to 8.191 where nothing came back; one that measures up to 80 m more than that.
"""

import os
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError, shown
from ..files.input import names_file
from ..files.sizes import DriveLength
from ..geometry import wrap_angle
from ..scan import LaserScan
from .drive import RecordedDrive
from .text import LARGEST, first_line, numbered_lines, numbers, whole_number

_LASER = (0.40, 0.0, 0.0)  # T_robot_lidar
_NEAR, _FAR, _CODES = 8.0, 81.0, 8.192  # [m] what either kind measures; values up to the last are of the first kind
_MOST = 361  # beams: one a degree around


def is_dpslam_log(path: str | os.PathLike[str]) -> bool:
    """Return whether the first line that says anything is an `Odometry` or `Laser` line.

    Raises:
        InputError: If the file cannot be read.
    """
    return [word.lower() for word in first_line(path).split()[:1]] in (["odometry"], ["laser"])


@names_file
def read_dpslam_log(path: str | os.PathLike[str]) -> RecordedDrive:
    """Return the drive; all its times are 0, and the notes say so.

    Raises:
        InputError: If the file cannot be read, a line is cut, not numeric, of another kind or out of turn (with its
            number), or there is no scan.
    """
    file = Path(path)
    poses: list[list[float]] = []
    sweeps: list[NDArray[np.float64]] = []
    length = DriveLength(file)
    for number, line in numbered_lines(file):
        words = line.split()
        if not words:
            continue
        where, due = f"{file}:{number}", "laser" if len(poses) > len(sweeps) else "odometry"
        if words[0].lower() != due:
            raise InputError(f"{where}: expected a line that begins with {due.title()}, got {shown(words[0], 20)}")
        if due == "odometry":
            poses.append(_pose(words[1:], where))
        else:
            sweeps.append(_ranges(words[1:], where))
            length.add(len(sweeps[-1]))
    if not sweeps:
        raise InputError(f"{file}: no laser scan found; expected lines that begin with Odometry and Laser")
    odometry = np.array(poses[: len(sweeps)])
    odometry[:, 2] = wrap_angle(odometry[:, 2])
    limit = _NEAR if max(float(sweep.max()) for sweep in sweeps) < _CODES else _FAR
    scans = [_scan(sweep, limit) for sweep in sweeps]
    return RecordedDrive(odometry, scans, None, file.name.split(".")[0], notes=("the log has no times",))


def _pose(words: list[str], where: str) -> list[float]:
    pose = numbers(words, where, "a number")
    if len(pose) != 3 or not all(abs(value) <= LARGEST for value in pose):
        raise InputError(f"{where}: needs x, y and theta after Odometry, got {shown(' '.join(words))}")
    return pose


def _ranges(words: list[str], where: str) -> NDArray[np.float64]:
    count = (whole_number(words[0]) or 0) if words else 0
    if not 2 <= count <= _MOST or len(words) != count + 1:
        raise InputError(
            f"{where}: needs the number of beams, 2 to {_MOST}, and as many ranges, got {len(words)} words"
        )
    ranges = np.array(numbers(words[1:], where, "a range [m]"))
    if not (np.isfinite(ranges) & (ranges >= 0.0)).all():
        raise InputError(f"{where}: ranges must be finite and not negative [m]")
    return ranges


def _scan(ranges: NDArray[np.float64], limit: float) -> LaserScan:
    bearings = np.radians(np.arange(len(ranges)) - 90.0)
    ranges = np.where(ranges > 0.0, ranges, np.nan)
    return LaserScan(np.where(ranges >= limit, np.inf, ranges), bearings, 0.0, limit, 0.0, _LASER)
