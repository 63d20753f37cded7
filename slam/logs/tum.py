"""Trajectories in the TUM format: one line a pose, `t x y z qx qy qz qw`."""

import os
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..bounds import check_poses, check_times
from ..errors import InputError, shown
from ..files.input import names_file
from ..geometry import wrap_angle
from .text import MOST_POSES, finite_numbers, numbered_lines, write_lines

_TILT_LIMIT = 0.02  # norm of (qx, qy): about 2 degrees of roll and pitch


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Poses at known times.

    Attributes:
        times_s: (n,) times [s].
        poses: (n, 3) poses of the robot in the map or world frame [m, m, rad].

    Raises:
        InputError: If the shapes do not agree, or a number is not finite or beyond what it can be.
    """

    times_s: NDArray[np.float64]
    poses: NDArray[np.float64]

    def __post_init__(self) -> None:
        if self.times_s.ndim != 1 or self.poses.shape != (len(self.times_s), 3):
            raise InputError(
                f"a trajectory needs `times_s` (n,) and `poses` (n, 3), got {self.times_s.shape}, {self.poses.shape}"
            )
        check_times(self.times_s, "times_s")
        check_poses(self.poses, "poses", jumps=False)

    def __len__(self) -> int:
        return len(self.times_s)


@names_file
def read_tum(path: str | os.PathLike[str]) -> Trajectory:
    """Read a TUM trajectory (plain or gzipped) of a robot on the plane; z is ignored.

    Raises:
        InputError: With file and line, if a line has not eight finite numbers, its quaternion is not of unit length or
            turns out of the plane; or if there is no pose at all.
    """
    times, poses = [], []
    for number, line in numbered_lines(path, most_lines=MOST_POSES):
        words = line.split("#", 1)[0].split()
        if not words:
            continue
        where = f"{os.fspath(path)}:{number}"
        if len(words) != 8:
            raise InputError(f"{where}: a TUM line needs 8 numbers (t x y z qx qy qz qw), got {len(words)}")
        t, x, y, _, qx, qy, qz, qw = finite_numbers(words, where)
        if abs(np.linalg.norm((qx, qy, qz, qw)) - 1.0) > 1e-2:
            raise InputError(f"{where}: needs a quaternion of length 1, got {shown(' '.join(words[4:]))}")
        if np.hypot(qx, qy) > _TILT_LIMIT:
            raise InputError(f"{where}: needs a rotation about z only (qx = qy = 0), got qx={qx}, qy={qy}")
        times.append(t)
        poses.append((x, y, 2.0 * np.arctan2(qz, qw)))
    if not poses:
        raise InputError(f"{os.fspath(path)}: needs at least one TUM line (t x y z qx qy qz qw), got none")
    trajectory = np.array(poses)
    trajectory[:, 2] = wrap_angle(trajectory[:, 2])
    return Trajectory(np.array(times), trajectory)


def write_tum(path: str | os.PathLike[str], trajectory: Trajectory) -> None:
    """Write a trajectory as TUM lines: microseconds, micrometres, nine digits of the quaternion; .gz by name."""
    half = trajectory.poses[:, 2] / 2.0
    rows = zip(trajectory.times_s, trajectory.poses, np.sin(half), np.cos(half), strict=True)
    write_lines(path, (f"{t:.6f} {p[0]:.6f} {p[1]:.6f} 0 0 0 {qz:.9f} {qw:.9f}" for t, p, qz, qw in rows))
