"""Reads CARMEN logs: `FLASER`, `ROBOTLASER1` and `ODOM` lines, plain or gzipped.

Layouts (CARMEN robot navigation toolkit, logger):
    FLASER n r1..rn x y theta odom_x odom_y odom_theta ipc_time host logger_time
    ROBOTLASER1 type start_angle fov resolution max_range accuracy remission_mode n r1..rn m e1..em
        laser_x laser_y laser_theta x y theta tv rv forward_safety side_safety turn_axis ipc_time host logger_time
    ODOM x y theta tv rv accel ipc_time host logger_time
"""

import os
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError, one_line, shown
from ..files.input import names_file
from ..files.sizes import DriveLength
from ..geometry import between, compose, wrap_angle
from ..scan import LaserScan
from .beams import cut_behind, measured
from .drive import RecordedDrive
from .text import LARGEST, numbered_bytes, whole_number

Pose = tuple[float, float, float]

# Status codes of SICK lasers stand up to half a percent below the log's largest value (51.14 .. 51.25 in one log).
_NO_RETURN_SHARE = 0.995
_SAME_POSE = 1e-3  # [m, rad] two pose fields that differ by less say the same


class LaserRecord(NamedTuple):
    """One laser line: ranges as written, bearings (same shape), what the line says about range limits and poses."""

    ranges: NDArray[np.float64]
    bearings: NDArray[np.float64]
    max_range: float | None
    laser: Pose
    robot: Pose
    time_s: float


@names_file
def read_carmen(path: str | os.PathLike[str], T_robot_lidar: Pose | None = None) -> RecordedDrive:
    """Return the drive in a CARMEN log (`.log`, `.clf`, each also gzipped; told by its first bytes).

    Ranges at the log's maximum (`FLASER`: its largest value and the status codes just below; `ROBOTLASER1`: the
    `max_range` of the line) become `inf`, "no return"; 0.0 becomes NaN, "no measurement". `FLASER` beams cover 180
    degrees from the right to the left. `ODOM` lines are checked, and skipped: each laser line carries its odometry.
    `x y theta` of a `FLASER` line becomes `reference` where it says something else than its odometry.

    Args:
        path: The log.
        T_robot_lidar: Pose of the laser on the robot [m, m, rad]. None takes the log's own: `ROBOTLASER1` lines have
            it, for `FLASER` it is `PARAM robot_frontlaser_offset`, else the robot's origin.

    Raises:
        InputError: If the file cannot be read, a line is cut or not numeric (with its number), or no scan is in it.
    """
    path = Path(path)
    flaser, robotlaser, offset = _parse(path)
    records = robotlaser or flaser
    if not records:
        raise InputError(f"{path}: no laser scan found; expected lines beginning with FLASER or ROBOTLASER1")
    odometry = np.array([record.robot for record in records])
    odometry[:, 2] = wrap_angle(odometry[:, 2])
    mount = np.broadcast_to(np.array([offset, 0.0, 0.0]), odometry.shape)
    reference = None
    if robotlaser:
        mount = np.round(between(odometry, np.array([record.laser for record in records])), 4) + 0.0
    else:
        reference = _reference(odometry, np.array([record.laser for record in records]), mount)
    if T_robot_lidar is not None:
        mount = np.broadcast_to(np.asarray(T_robot_lidar, dtype=np.float64), odometry.shape)
    scans = _scans(records, mount)
    return RecordedDrive(odometry=odometry, scans=scans, reference=reference, name=path.name.split(".")[0])


def _parse(path: Path) -> tuple[list[LaserRecord], list[LaserRecord], float]:
    """Return FLASER records, ROBOTLASER1 records and the offset of the front laser [m]."""
    flaser: list[LaserRecord] = []
    robotlaser: list[LaserRecord] = []
    offset, length = 0.0, DriveLength(path)
    for number, line in numbered_bytes(path):
        words = line.split()
        if not words or words[0].startswith(b"#"):
            continue
        kind = words[0]
        try:
            if kind in (b"FLASER", b"ROBOTLASER1"):
                record = laser_record(words)
                length.add(len(record.ranges))
                (flaser if kind == b"FLASER" else robotlaser).append(record)
            elif kind == b"ODOM":
                _floats(words[1:8], 7, "x y theta tv rv accel time")
            else:
                found = front_offset(words)
                offset = offset if found is None else found
        except InputError:
            raise
        except ValueError as error:
            raise InputError(f"{path}, line {number}: {kind.decode('latin-1')}: {error}") from error
    return flaser, robotlaser, offset


def laser_record(words: list[bytes]) -> LaserRecord:
    """Return what the words of a FLASER or ROBOTLASER1 line say.

    Raises:
        ValueError: If the line is cut, or a word is no number.
    """
    return _flaser(words) if words[0] == b"FLASER" else _robotlaser(words)


def first_reading(words: list[bytes]) -> int:
    """Return which of the words of a sound FLASER or ROBOTLASER1 line is its first range."""
    return 2 if words[0] == b"FLASER" else 9


def front_offset(words: list[bytes]) -> float | None:
    """Return how far ahead of the robot's centre the laser of FLASER lines is [m], if a PARAM line says that."""
    if words[:2] != [b"PARAM", b"robot_frontlaser_offset"]:
        return None
    return float(_floats(words[2:3], 1, "the offset of the front laser")[0])


def _floats(words: list[bytes], count: int, what: str) -> NDArray[np.float64]:
    """Return `count` numbers; raise ValueError that says `what` was expected."""
    if len(words) < count:
        raise ValueError(f"the line is cut: expected {count} numbers ({what}), got {len(words)}")
    try:
        return np.fromiter(map(float, words[:count]), np.float64, count)
    except ValueError as error:
        raise ValueError(f"expected numbers ({what}): {one_line(str(error), 100)}") from None


def _count(words: list[bytes], index: int, what: str) -> int:
    count = whole_number(words[index]) if len(words) > index else None
    if count is None:
        got = words[index].decode("latin-1") if len(words) > index else "the end of the line"
        raise ValueError(f"expected the number of {what}, got {shown(got)}")
    return count


def _poses(values: NDArray[np.float64]) -> tuple[Pose, Pose]:
    if not (np.abs(values[:6]) <= LARGEST).all():
        raise ValueError(f"expected finite poses of at most {LARGEST:g}, got {shown(values[:6].tolist())}")
    x, y, theta, odom_x, odom_y, odom_theta = values[:6].tolist()
    return (x, y, theta), (odom_x, odom_y, odom_theta)


def _ranges(words: list[bytes], count: int) -> NDArray[np.float64]:
    ranges = _floats(words, count, f"{count} ranges")
    bad = np.flatnonzero(~(ranges >= 0.0))
    if len(bad):
        raise ValueError(f"expected ranges from 0 m on, got {ranges[bad[0]]} in beam {bad[0] + 1} of {count}")
    return ranges


def _flaser(words: list[bytes]) -> LaserRecord:
    count = _count(words, 1, "ranges")
    ranges = _ranges(words[2:], count)
    tail = _floats(words[2 + count :], 7, "x y theta odom_x odom_y odom_theta time")
    laser, robot = _poses(tail)
    return LaserRecord(ranges, _half_circle(count), None, laser, robot, float(tail[6]))


def _robotlaser(words: list[bytes]) -> LaserRecord:
    head = _floats(words[1:8], 7, "type start_angle fov resolution max_range accuracy remission_mode")
    count = _count(words, 8, "ranges")
    ranges = _ranges(words[9:], count)
    remissions = _count(words, 9 + count, "remission values")
    tail = _floats(
        words[10 + count + remissions :],
        12,
        "laser x y theta, robot x y theta, tv rv, three safety distances, time",
    )
    if not (np.isfinite(head[1:5]).all() and head[3] > 0.0 and head[4] > 0.0):
        raise ValueError(f"expected finite angles, a positive resolution and a positive max_range, got {head[1:5]}")
    bearings = _fan(count, float(head[1]), float(head[3]))
    laser, robot = _poses(tail)
    return LaserRecord(ranges, bearings, float(head[4]), laser, robot, float(tail[11]))


@lru_cache(maxsize=8)
def _half_circle(count: int) -> NDArray[np.float64]:
    """Bearings of `count` beams from -90 degrees: odd counts reach +90 degrees, even ones end a step before."""
    return _fan(count, -np.pi / 2.0, np.pi / max(count - count % 2, 1))


@lru_cache(maxsize=8)
def _fan(count: int, start: float, step: float) -> NDArray[np.float64]:
    bearings: NDArray[np.float64] = start + step * np.arange(count, dtype=np.float64)
    bearings.setflags(write=False)
    return bearings


def _scans(records: list[LaserRecord], mounts: NDArray[np.float64]) -> list[LaserScan]:
    log_maximum = no_return_from(max((largest_range(record) for record in records), default=0.0))
    return [scan_of(record, mount, log_maximum)[0] for record, mount in zip(records, mounts.tolist(), strict=True)]


def largest_range(record: LaserRecord) -> float:
    """Return the largest finite range of a line [m], 0 where there is none."""
    return float(np.nanmax(record.ranges, initial=0.0, where=np.isfinite(record.ranges)))


def no_return_from(largest: float) -> float:
    """Return the range [m] from which on a FLASER line means "no return", by the `largest` one of its log [m]."""
    return (largest or 1.0) * _NO_RETURN_SHARE


def scan_of(record: LaserRecord, mount: Pose, log_maximum: float) -> tuple[LaserScan, NDArray[np.intp]]:
    """Return the scan that a line says, and which of its ranges each beam is; the ranges of the line are overwritten.

    Args:
        record: The line.
        mount: T_robot_lidar.
        log_maximum: As of `no_return_from`, for lines that do not say the largest range themselves [m].
    """
    limit = log_maximum if record.max_range is None else record.max_range
    beyond = record.ranges >= limit
    record.ranges[:] = measured(record.ranges)  # in place: a long drive should not stand twice in memory
    record.ranges[beyond] = np.inf
    order, bearings = cut_behind(np.arange(len(record.ranges)), record.bearings, mount[2])
    ranges = record.ranges if len(order) == len(record.ranges) and bearings is record.bearings else record.ranges[order]
    return LaserScan(ranges, bearings, 0.0, limit, record.time_s, (mount[0], mount[1], mount[2])), order


def _reference(
    odometry: NDArray[np.float64], poses: NDArray[np.float64], mount: NDArray[np.float64]
) -> NDArray[np.float64] | None:
    """Return the corrected poses (n, 3), None where `poses` repeat the odometry of the robot or of its laser."""
    for repeated in (odometry, compose(odometry, mount)):
        difference = poses - repeated
        difference[:, 2] = wrap_angle(difference[:, 2])
        if np.abs(difference).max() < _SAME_POSE:
            return None
    poses = poses.copy()
    poses[:, 2] = wrap_angle(poses[:, 2])
    return poses
