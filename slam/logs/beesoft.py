"""Reads what BeeSoft-style robots of CMU recorded: `L` and `O` lines of a drive, and maps after `global_map[0]:`.

Layouts (centimetres and radians):
    L x y theta laser_x laser_y laser_theta r1..r180 time     odometry pose, the laser's pose there, ranges
    O x y theta time                                          odometry alone
    robot_specifications->resolution 10                       side of a cell of the map
    global_map[0]: nx ny                                      then nx lines of ny values, one line for each x
The 180 ranges go from the right to the left, one degree apart. A value of a map is the probability that a cell is free,
-1 where nothing is known.
"""

import os
from collections.abc import Iterator
from itertools import islice
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError, shown
from ..files.input import names_file
from ..files.sizes import MOST_PIXELS, DriveLength
from ..geometry import between, wrap_angle
from ..occupancy_map import OccupancyMap
from ..scan import LaserScan
from .drive import RecordedDrive
from .text import LARGEST, first_line, numbered_lines, numbers, whole_number

_BEAMS = 180
_BEARINGS = np.radians(np.arange(_BEAMS) - 89.5)
_RANGE_MAX = 81.0  # [m] a SICK's; it writes 81.83 where nothing came back
_CM = 0.01
_OCCUPIED_ABOVE, _FREE_BELOW = 0.65, 0.196  # as ROS; much that no beam reached stands at 0.27 to 0.42
_GRID = "global_map[0]:"
_RESOLUTION = "robot_specifications->resolution"


def is_beesoft_log(path: str | os.PathLike[str]) -> bool:
    """Return whether the first line that says anything is an `L` or `O` line.

    Raises:
        InputError: If the file cannot be read.
    """
    return first_line(path).split()[:1] in (["L"], ["O"])


def is_beesoft_map(path: str | os.PathLike[str]) -> bool:
    """Return whether the first line that says anything belongs to a BeeSoft map.

    Raises:
        InputError: If the file cannot be read.
    """
    return first_line(path).startswith(("robot_specifications->", _GRID))


@names_file
def read_beesoft_log(path: str | os.PathLike[str]) -> RecordedDrive:
    """Return the drive of the `L` lines; `O` lines are checked, and skipped.

    Raises:
        InputError: If the file cannot be read, a line is cut, not numeric or of another kind (with its number), or
            there is no scan.
    """
    file, odometry, scans = Path(path), [], []
    length = DriveLength(file)
    for number, line in numbered_lines(file):
        words = line.split()
        if not words:
            continue
        where = f"{file}:{number}"
        count = {"L": 6 + _BEAMS + 1, "O": 4}.get(words[0])
        if count is None:
            raise InputError(f"{where}: expected a line that begins with L or O, got {shown(words[0], 20)}")
        if len(words) != count + 1:
            raise InputError(f"{where}: needs {count} numbers after {words[0]}, got {len(words) - 1}")
        values = np.array(numbers(words[1:], where, "a number"))
        if not (np.abs(values[:6]) <= LARGEST).all():
            raise InputError(f"{where}: expected finite poses of at most {LARGEST:g}, got {shown(words[1:7])}")
        if words[0] == "L":
            length.add(_BEAMS)
            pose, laser = values[:3] * [_CM, _CM, 1.0], values[3:6] * [_CM, _CM, 1.0]
            odometry.append([*pose[:2], float(wrap_angle(pose[2]))])
            scans.append(_scan(values[6:-1] * _CM, np.round(between(pose, laser), 3) + 0.0, float(values[-1])))
    if not scans:
        raise InputError(f"{file}: no laser scan found; expected lines that begin with L")
    return RecordedDrive(np.array(odometry), scans, None, file.name.split(".")[0])


def _scan(ranges: NDArray[np.float64], mount: NDArray[np.float64], time_s: float) -> LaserScan:
    ranges = np.where(ranges > 0.0, ranges, np.nan)
    x, y, theta = mount.tolist()
    return LaserScan(np.where(ranges >= _RANGE_MAX, np.inf, ranges), _BEARINGS, 0.0, _RANGE_MAX, time_s, (x, y, theta))


@names_file
def read_beesoft_map(path: str | os.PathLike[str]) -> OccupancyMap:
    """Read a map; its frame begins at the outer corner of the first cell.

    Raises:
        InputError: If the file cannot be read, has no resolution or no grid, or the grid is too large, cut or not
            numeric.
    """
    file = Path(path)
    lines = ((f"{file}:{number}", line.split()) for number, line in numbered_lines(file))
    resolution, shape = _map_header(file, lines)
    rows = list(islice((_map_row(where, words, shape[1]) for where, words in lines if words), shape[0]))
    if len(rows) < shape[0]:
        raise InputError(f"{file}: the grid is cut: needs {shape[0]} lines, got {len(rows)}")
    free = np.array(rows).T
    occupancy = np.where(free < 0.0, np.nan, 1.0 - free).astype(np.float32)
    return OccupancyMap(occupancy, resolution, (0.0, 0.0), _OCCUPIED_ABOVE, _FREE_BELOW)


def _map_header(file: Path, lines: Iterator[tuple[str, list[str]]]) -> tuple[float, tuple[int, int]]:
    """Return the side of a cell [m] and the numbers of cells in x and y; `lines` then stand before the first row."""
    resolution = 0.0
    for where, words in lines:
        if words[:1] == [_RESOLUTION]:
            resolution = _CM * numbers(words[1:2], where, "the side of a cell [cm]")[0] if words[1:] else 0.0
        elif words[:1] == [_GRID]:
            nx, ny = (whole_number(word) or 0 for word in (*words[1:3], "", "")[:2])
            if nx * ny == 0:
                raise InputError(f"{where}: the size of the grid needs two positive numbers, got {shown(words[1:])}")
            if nx * ny > MOST_PIXELS:
                raise InputError(f"{where}: a map has at most {MOST_PIXELS} cells, got {nx} x {ny}")
            if not 0.0 < resolution < np.inf:
                break
            return resolution, (nx, ny)
    raise InputError(f"{file}: no map found; expected `{_RESOLUTION} CM` and `{_GRID} NX NY`")


def _map_row(where: str, words: list[str], count: int) -> NDArray[np.float32]:
    """Return the `count` values of a line: how likely each cell is free, -1 where nothing is known."""
    if len(words) != count:
        raise InputError(f"{where}: needs {count} values, got {len(words)}")
    values = np.array(numbers(words, where, "a probability or -1"))
    wrong = values[~(values <= 1.0)]
    if len(wrong):
        raise InputError(f"{where}: expected a probability or -1, got {wrong[0]:g}")
    return values.astype(np.float32)
