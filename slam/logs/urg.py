"""Reads drives of a wheeled robot with a Hokuyo URG-04LX as the tinySLAM project (Mines ParisTech) recorded them.

One line a scan, without a header, told apart by its length:
    707 numbers: time [us], -, left and right encoder [ticks], 20 of other sensors, 683 ranges
    695 numbers: time [us], left and right encoder [ticks], odometry pose x, y [m] and theta [deg], 6 unused, 683 ranges
Ranges are in millimetres, from the right to the left; below 20 stand codes of errors, and 0 says "none". The robot as
tinySLAM describes it: wheels of 77 mm radius, 165 mm beside the middle, 2000 ticks a turn, laser 145 mm ahead.
"""

import os
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..files.input import names_file
from ..files.sizes import DriveLength
from ..geometry import wrap_angle
from ..scan import LaserScan
from .drive import RecordedDrive
from .text import finite_numbers, first_line, numbered_lines

_BEAMS = 683
_BEARINGS = np.radians((np.arange(_BEAMS) - _BEAMS // 2) * 360.0 / 1024.0)
_USABLE = slice(70, _BEAMS - 70)  # the robot itself stands before the others
_RANGE_MIN, _RANGE_MAX = 0.02, 5.6  # [m] the second is the most that the laser ever says
_LASER = (0.145, 0.0, 0.0)  # T_robot_lidar
_WHEEL_RADIUS, _HALF_AXLE, _TICKS = 0.077, 0.165, 2000.0  # [m, m, a turn]
_ENCODERS, _POSE = 707, 695  # numbers in a line of either layout


def is_urg_log(path: str | os.PathLike[str]) -> bool:
    """Return whether the first line that says anything has the length of either layout and is numeric.

    Raises:
        InputError: If the file cannot be read.
    """
    words = first_line(path).split()
    return len(words) in (_ENCODERS, _POSE) and words[0].lstrip("-").isdigit()


@names_file
def read_urg_log(path: str | os.PathLike[str]) -> RecordedDrive:
    """Return the drive; a last line that was cut is left out, and said in the notes.

    Raises:
        InputError: If the file cannot be read, a line but the last is cut or not numeric (with its number), or there is
            no whole line.
    """
    file, heads, scans = Path(path), [], []
    count, room = 0, DriveLength(path)
    cut: tuple[int, int] | None = None  # number and length of a line that is too short
    for number, line in numbered_lines(file):
        words = line.split()
        if not words:
            continue
        count = count or len(words)
        if count not in (_ENCODERS, _POSE):
            break
        if cut is not None or len(words) > count:
            where, got = cut or (number, len(words))
            raise InputError(f"{file}:{where}: needs {count} numbers, got {got}")
        if len(words) < count:
            cut = number, len(words)
            continue
        room.add(_BEAMS)
        values = np.array(finite_numbers(words, f"{file}:{number}"))
        heads.append(values[:-_BEAMS].copy())
        scans.append(_scan(values[-_BEAMS:] * 1e-3, values[0] * 1e-6))
    if not scans:
        raise InputError(f"{file}: needs {_ENCODERS} or {_POSE} numbers a line, got {count}")
    head = np.array(heads)
    odometry = _rolled(head[:, 2:4]) if count == _ENCODERS else head[:, 3:6] * [1.0, 1.0, np.pi / 180.0]
    odometry[:, 2] = wrap_angle(odometry[:, 2])
    notes = () if cut is None else (f"the last line ({cut[0]}) is cut and was left out",)
    return RecordedDrive(odometry, scans, None, file.name.split(".")[0], notes=notes)


def _rolled(ticks: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (n, 3) poses from the first on, by the counts (n, 2) of the left and the right wheel."""
    left, right = (np.diff(ticks, axis=0) * (2.0 * np.pi * _WHEEL_RADIUS / _TICKS)).T
    heading = np.concatenate(([0.0], np.cumsum((right - left) / (2.0 * _HALF_AXLE))))
    middle, way = 0.5 * (heading[1:] + heading[:-1]), 0.5 * (left + right)
    steps = way[:, None] * np.stack((np.cos(middle), np.sin(middle)), axis=-1)
    places = np.concatenate((np.zeros((1, 2)), np.cumsum(steps, axis=0)))
    return np.column_stack((places, heading))


def _scan(ranges: NDArray[np.float64], time_s: float) -> LaserScan:
    usable = ranges[_USABLE]
    usable = np.where(usable < _RANGE_MIN, np.nan, usable)
    return LaserScan(usable, _BEARINGS[_USABLE], _RANGE_MIN, _RANGE_MAX, time_s, _LASER)
