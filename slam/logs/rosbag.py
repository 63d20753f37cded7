"""Reads a drive from a ROS 1 or ROS 2 bag: laser scans, odometry and where the laser stands on the robot."""

import os
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError, shown
from ..files.input import names_file
from ..files.sizes import DriveLength
from ..geometry import wrap_angle
from ..scan import LaserScan
from .bag_messages import Bag, as_defined, open_bag
from .beams import cut_behind, measured
from .drive import RecordedDrive
from .ros_frames import FrameTree, frame_name, planar, rotation_matrix, stamp_s

Array = NDArray[np.float64]
Pose = tuple[float, float, float]

SCAN, ODOMETRY = "sensor_msgs/msg/LaserScan", "nav_msgs/msg/Odometry"
ECHOES = "sensor_msgs/msg/MultiEchoLaserScan"
SCANS = (SCAN, ECHOES)
"""Types of messages that hold a scan."""
TRANSFORMS = ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage")

_BASES = ("base_link", "base_footprint", "base")  # REP 105, where the odometry does not name the robot's frame
_LEVEL = 0.94  # cosine of the tilt from which on a laser is not called planar
_CLOCKS_S = 0.5  # two clocks that differ by more are not the same
_BEYOND_S = 0.2  # a scan longer than this before or after all odometry has none
_GAP_S = 1.0  # nor has one between two poses of it that are farther apart in time


@dataclass(eq=False)
class Poses:
    """Odometry: times by header and by recorder [s], poses (3,), name of the robot's frame and what told it."""

    robot: str = ""
    source: str = ""
    times_s: list[float] = field(default_factory=list)
    recorded_s: list[float] = field(default_factory=list)
    poses: list[Array] = field(default_factory=list)

    def add(self, content: Any, recorded_s: float) -> None:
        """Take a `nav_msgs/Odometry` that was recorded at `recorded_s` [s]."""
        self.robot = frame_name(content.child_frame_id)
        self.times_s.append(stamp_s(content.header))
        self.recorded_s.append(recorded_s)
        self.poses.append(planar(content.pose.pose.position, rotation_matrix(content.pose.pose.orientation)))


class SaidScan(NamedTuple):
    """What a message of a scan says; times by header and by recorder [s]."""

    frame: str
    stamp_s: float
    recorded_s: float
    ranges: Array
    angle_min: float
    angle_increment: float
    range_min: float
    range_max: float

    @classmethod
    def said_by(cls, content: Any, recorded_s: float) -> "SaidScan":
        """Return what a scan of `SCANS` says that was recorded at `recorded_s` [s]; of several echoes the first."""
        limits = (content.angle_min, content.angle_increment, content.range_min, content.range_max)
        ranges = np.asarray(first_echoes(content.ranges), dtype=np.float64).reshape(-1)
        frame, stamp = frame_name(content.header.frame_id), stamp_s(content.header)
        return cls(frame, stamp, recorded_s, ranges, *map(float, limits))


@names_file
def read_rosbag(
    path: str | os.PathLike[str], scan_topic: str | None = None, odometry_topic: str | None = None
) -> RecordedDrive:
    """Return the drive in a bag: a ROS 1 file, or the folder (or mcap file) of a ROS 2 bag.

    Topics are found by type: scans are `sensor_msgs/LaserScan`, or `MultiEchoLaserScan`, of each beam the first echo,
    as Cartographer takes it; odometry is `nav_msgs/Odometry`, or else what tf tells of the laser's ancestor in a frame
    that is called odom; where there is neither, `has_odometry` is false. The laser's place on the robot is that of tf;
    one that hangs upside down has its beams turned over, a sweep of the full circle is cut behind the robot, and a
    range of 0 is no measurement. Odometry is interpolated at the scans; those in a gap of it of more than 1 s are left
    out. Times are those of the message headers, or of the recorder where the headers of scans and odometry disagree or
    stand still. What was assumed is told in `notes`.

    Args:
        path: The bag.
        scan_topic: Name of the scans' topic, needed where there are several.
        odometry_topic: Name of the odometry's topic, likewise.

    Raises:
        InputError: If it is no bag, damaged, without scans, ambiguous, or its laser does not stand level.
        MissingExtraError: If `rosbags` is not installed.
    """
    path = Path(path)
    if not path.exists():
        raise InputError(f"{path}: cannot be read (no such file or folder)")
    with open_bag(path) as bag:
        topic = choose_scans(bag, scan_topic, path)
        sweeps = _sweeps(bag, topic, path)
        tree = FrameTree(bag.messages(*bag.of_type(*TRANSFORMS)))
        frame = sweeps[0].frame
        odometry = _odometry(bag, tree, frame, odometry_topic, path)
    notes: list[str] = []
    mount, flipped = laser_mount(tree, odometry.robot if odometry else None, frame, notes, path)
    headers, recorded = (np.array(times) for times in zip(*((s.stamp_s, s.recorded_s) for s in sweeps), strict=True))
    by_header = headers_are_good(headers, recorded, odometry)
    times = headers if by_header else recorded
    where, reach = f"{path}: {topic}", _farthest(sweeps)
    placed = zip(sweeps, times.tolist(), strict=True)
    scans = [placed_scan(sweep, time_s, reach, mount, flipped, where)[0] for sweep, time_s in placed]
    if odometry is None:
        notes.append("no odometry in the bag")
        return RecordedDrive(np.zeros((len(scans), 3)), scans, None, path.stem, has_odometry=False, notes=tuple(notes))
    poses, inside = _at(times, np.array(odometry.times_s if by_header else odometry.recorded_s), odometry.poses)
    if not inside.any():
        limits = f"within {_BEYOND_S} s of it and between poses {_GAP_S} s apart at most"
        raise InputError(f"{path}: no scan of {topic} has odometry of {odometry.source}: {limits}")
    if not inside.all():
        notes.append(f"{np.count_nonzero(~inside)} scans left out: no odometry at their time")
    kept = [scan for scan, good in zip(scans, inside, strict=True) if good]
    return RecordedDrive(poses[inside], kept, None, path.stem, notes=tuple(notes))


def first_echoes(ranges: Any) -> Any:
    """Return the ranges of a message, where each beam has several echoes the first one of each; NaN: it has none."""
    if len(ranges) and hasattr(ranges[0], "echoes"):
        return np.array([beam.echoes[0] if len(beam.echoes) else np.nan for beam in ranges], dtype=np.float32)
    return ranges


def choose_scans(bag: Bag, wanted: str | None, path: Path) -> str:
    """Return the topic of the scans: the only one, or the `wanted` one."""
    topic = bag.choose(wanted, SCANS, "--scan-topic")
    if topic is None:
        known = ", ".join(f"{name} ({kind})" for name, kind in sorted(bag.topics.items()))
        raise InputError(f"{path}: no topic of type {' or '.join(SCANS)}; it has: {known or 'no messages'}")
    return topic


def _sweeps(bag: Bag, topic: str, path: Path) -> list[SaidScan]:
    """Return what the scans of a topic say."""
    sweeps, room = [], DriveLength(path)
    for recorded_s, content in bag.messages(topic):
        with as_defined(f"{path}: {topic}"), np.errstate(invalid="ignore"):  # bytes that are no number stay none
            room.add(len(content.ranges))
            sweeps.append(SaidScan.said_by(content, recorded_s))
    return sweeps


def _odometry(bag: Bag, tree: FrameTree, laser: str, wanted: str | None, path: Path) -> Poses | None:
    """Return the odometry of the robot that carries the frame `laser`; None: the bag says nothing of it."""
    topic = bag.choose(wanted, (ODOMETRY,), "--odometry-topic")
    if topic is not None:
        result = Poses(source=topic)
        for recorded_s, content in bag.messages(topic):
            with as_defined(f"{path}: {topic}"):
                result.add(content, recorded_s)
        return result
    return odometry_of_frames(tree, laser)


def odometry_of_frames(tree: FrameTree, laser: str) -> Poses | None:
    """Return how the ancestor of the frame `laser` moved in a frame that is called odom; None: there is none."""
    for child, parent in pairwise(tree.upwards(laser)):
        if "odom" in parent:
            track = tree.track(child)
            return Poses(child, f"tf {parent} -> {child}", track.times_s, track.recorded_s, track.poses)
    return None


def laser_mount(tree: FrameTree, robot: str | None, laser: str, notes: list[str], path: Path) -> tuple[Pose, bool]:
    """Return T_robot_lidar in the plane, and whether the laser hangs upside down."""
    for base in (robot, *_BASES) if robot else _BASES:
        matrix = tree.between(base, laser)
        if matrix is None:
            continue
        up = matrix[2, 2]
        if abs(up) < _LEVEL:
            raise InputError(
                f"{path}: the laser {shown(laser)} must stand level on {shown(base)}, its axis has cosine {up:.2f}"
            )
        return (float(matrix[0, 3]), float(matrix[1, 3]), float(np.arctan2(matrix[1, 0], matrix[0, 0]))), up < 0.0
    notes.append(f"no transform from the robot to {shown(laser)}: the laser counts as the robot's origin")
    return (0.0, 0.0, 0.0), False


def headers_are_good(headers: Array, recorded: Array, odometry: Poses | None) -> bool:
    """Return whether the times in the headers are of use: they move on, and are of one clock."""
    if len(headers) > 1 and not (np.diff(headers) > 0.0).all():
        return False
    if odometry is None:
        return True
    offset = np.median(np.array(odometry.times_s) - np.array(odometry.recorded_s))
    return bool(abs(offset - np.median(headers - recorded)) < _CLOCKS_S)


def _farthest(sweeps: list[SaidScan]) -> float:
    """Return the largest range of all sweeps [m], 0 where nothing was met."""
    return float(max(np.max(sweep.ranges, initial=0.0, where=np.isfinite(sweep.ranges)) for sweep in sweeps))


def placed_scan(
    message: SaidScan, time_s: float, reach: float, mount: Pose, flipped: bool, where: str
) -> tuple[LaserScan, NDArray[np.intp]]:
    """Return the scan of a message, its bearings ascending, and which reading of the message each of its beams is.

    Args:
        message: What it says.
        time_s: Of the scan [s].
        reach: What a limit of `inf` is taken to be [m].
        mount: T_robot_lidar.
        flipped: Whether the laser hangs upside down.
        where: File and topic, for errors.
    """
    ranges = measured(message.ranges, message.range_min)
    first, step = message.angle_min, message.angle_increment
    if not (np.isfinite(first) and np.isfinite(step) and (step != 0.0 or len(ranges) < 2)):
        raise InputError(f"{where}: beams need a finite angle and step [rad], got {first} and {step}")
    bearings, order = first + step * np.arange(len(ranges), dtype=np.float64), np.arange(len(ranges))
    if flipped:
        bearings = -bearings
    if len(bearings) > 1 and bearings[1] < bearings[0]:
        order, bearings = order[::-1], bearings[::-1]
    order, bearings = cut_behind(order, bearings, mount[2])
    limit = message.range_max if message.range_max < np.inf else max(reach, message.range_min + 1.0)
    try:
        return LaserScan(ranges[order], bearings, message.range_min, limit, time_s, mount), order
    except InputError as error:
        raise InputError(f"{where}: {error}") from error


def _at(times_s: Array, known_s: Array, poses: list[Array]) -> tuple[Array, NDArray[np.bool_]]:
    """Return poses (n, 3) at `times_s` (n,) between those known at `known_s`, and which of them are known (n,).

    Not known are those farther than `_BEYOND_S` before or after all, and those in a gap longer than `_GAP_S`.
    """
    order = np.argsort(known_s, kind="stable")
    known_s, known = known_s[order], np.array(poses)[order]
    known[:, 2] = np.unwrap(known[:, 2])
    result = np.stack([np.interp(times_s, known_s, column) for column in known.T], axis=-1)
    result[:, 2] = wrap_angle(result[:, 2])
    before, after = np.searchsorted(known_s, times_s, "right") - 1, np.searchsorted(known_s, times_s, "left")
    last = len(known_s) - 1
    gaps = known_s[np.minimum(after, last)] - known_s[np.maximum(before, 0)]
    return result, (gaps <= _GAP_S) & (times_s >= known_s[0] - _BEYOND_S) & (times_s <= known_s[last] + _BEYOND_S)
