"""Files of hand-checked relations between poses (the SLAM benchmark of Kuemmerle et al. 2009), and of readings."""

import os
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..bounds import check_poses, check_times
from ..errors import InputError
from ..files.input import names_file
from .text import MOST_POSES, finite_numbers, numbered_lines

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Relations:
    """Where the robot stood at one moment, seen from where it stood at another.

    Attributes:
        first: (m,) moment one: time [s], or index of a reading.
        second: (m,) moment two, likewise.
        T_first_second: (m, 3) pose at moment two in the frame of the pose at moment one [m, m, rad].
        by_reading: Whether the moments are indices of readings; times otherwise.
    """

    first: Array
    second: Array
    T_first_second: Array
    by_reading: bool

    def __post_init__(self) -> None:
        check_times(self.first, "first")
        check_times(self.second, "second")
        check_poses(self.T_first_second, "T_first_second", jumps=False)


@dataclass(frozen=True, eq=False)
class Readings:
    """Raw odometry at every reading of a log, of which a shorter log holds only some.

    Attributes:
        times_s: (r,) times [s]; readings may share one, where the log's clock was coarse.
        odometry: (r, 3) T_odom_robot at each reading.
    """

    times_s: Array
    odometry: Array

    def __post_init__(self) -> None:
        check_times(self.times_s, "times_s")
        check_poses(self.odometry, "odometry")


@names_file
def read_relations(path: str | os.PathLike[str]) -> Relations:
    """Read relations: `t1 t2 x y z roll pitch yaw` (times), or `i1 i2 x y yaw` (indices of readings).

    Raises:
        InputError: With file and line, if a line has another number of columns than 8 or 5, or no finite number.
    """
    rows = _rows(path, (5, 8), "`t1 t2 x y z roll pitch yaw` or `i1 i2 x y yaw`")
    by_reading = rows.shape[1] == 5
    return Relations(rows[:, 0], rows[:, 1], rows[:, [2, 3, 4] if by_reading else [2, 3, 7]], by_reading)


@names_file
def read_readings(path: str | os.PathLike[str]) -> Readings:
    """Read readings: `index time log_time odom_x odom_y odom_theta`, index counting from 0.

    Raises:
        InputError: With file and line, if a line has not six finite numbers or the indices do not count from 0.
    """
    rows = _rows(path, (6,), "`index time log_time odom_x odom_y odom_theta`")
    wrong = np.nonzero(rows[:, 0] != np.arange(len(rows)))[0]
    if len(wrong):
        raise InputError(f"{os.fspath(path)}: readings must count from 0, got {rows[wrong[0], 0]:g} as no. {wrong[0]}")
    return Readings(rows[:, 1], rows[:, 3:6])


def _rows(path: str | os.PathLike[str], columns: tuple[int, ...], layout: str) -> Array:
    rows: list[list[float]] = []
    for number, line in numbered_lines(path, most_lines=MOST_POSES):
        words = line.split("#", 1)[0].split()
        if not words:
            continue
        where = f"{os.fspath(path)}:{number}"
        if len(words) not in columns or (rows and len(words) != len(rows[0])):
            raise InputError(f"{where}: a line needs {layout}, got {len(words)} words")
        rows.append(finite_numbers(words, where))
    if not rows:
        raise InputError(f"{os.fspath(path)}: needs at least one line {layout}, got none")
    return np.array(rows)
