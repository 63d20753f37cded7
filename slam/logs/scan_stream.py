"""The scans of a bag as its messages come, each with the odometry at its time, however long the bag is."""

import os
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..files.input import checked_name, named, names_file
from ..geometry import between, wrap_angle
from ..scan import LaserScan
from .bag_messages import Bag, Message, as_defined, open_bag
from .message_types import MessageTypes
from .ros_frames import FrameTree, frame_name, planar, rotation_matrix, stamp_s
from .rosbag import (
    ODOMETRY,
    TRANSFORMS,
    Pose,
    Poses,
    SaidScan,
    choose_scans,
    headers_are_good,
    laser_mount,
    odometry_of_frames,
    placed_scan,
)

Array = NDArray[np.float64]

_ENOUGH = 20  # scans, and poses of the odometry, that show whose clock is right
_LOOKED_AT_S = 60.0  # transforms that do not move are told again and again, or once at the beginning
_WAIT_S = 0.5  # so long a scan waits for the odometry after it


@dataclass(frozen=True, eq=False)
class BagBeginning:
    """What the first minute of a bag tells of the rest.

    Attributes:
        path: Of the bag.
        topics: All that it has, and the type of each.
        scans: Topic of the scans.
        odometry: Topic of the odometry, or "".
        moving: Frames (parent, child) whose transform is the odometry, where no topic is.
        mount: T_robot_lidar.
        flipped: Whether the laser hangs upside down.
        by_header: Whether the times are those of the message headers; else of the recorder.
        notes: What was assumed, a sentence each.
        types: Of its messages, or what reads them.
    """

    path: Path
    topics: dict[str, str]
    scans: str
    odometry: str
    moving: tuple[str, str] | None
    mount: Pose
    flipped: bool
    by_header: bool
    notes: tuple[str, ...]
    types: MessageTypes

    @property
    def has_odometry(self) -> bool:
        """Whether the bag tells how the robot moved."""
        return bool(self.odometry or self.moving)


@names_file
def read_beginning(
    path: str | os.PathLike[str], wanted_scans: str | None = None, wanted_odometry: str | None = None
) -> BagBeginning:
    """Return what the first minute of a bag tells, as `read_rosbag` would take it.

    Args:
        path: The bag.
        wanted_scans: Name of the scans' topic, needed where there are several.
        wanted_odometry: Name of the odometry's topic, likewise.

    Raises:
        InputError: As of `read_rosbag`.
    """
    path = checked_name(path)
    notes: list[str] = []
    with open_bag(path) as bag:
        scans = choose_scans(bag, wanted_scans, path)
        odometry = bag.choose(wanted_odometry, (ODOMETRY,), "--odometry-topic") or ""
        sweeps, poses, tree = _seen_first(bag, scans, odometry, path)
        topics, types = dict(bag.topics), bag.types
    frame = sweeps[0].frame
    told = poses if odometry else odometry_of_frames(tree, frame)
    moving = None if odometry or told is None else (tree.track(told.robot).parent, told.robot)
    place, flipped = laser_mount(tree, told.robot if told else None, frame, notes, path)
    headers = np.array([sweep.stamp_s for sweep in sweeps])
    by_header = headers_are_good(headers, np.array([sweep.recorded_s for sweep in sweeps]), told)
    if told is None:
        notes.append("no odometry in the bag: it is made from the scans")
    return BagBeginning(
        path, topics, scans, odometry, moving, place, flipped, by_header, notes=tuple(notes), types=types
    )


def _seen_first(bag: Bag, scans: str, odometry: str, path: Path) -> tuple[list[SaidScan], Poses, FrameTree]:
    """Return scans, odometry and frames from the beginning of a bag, as many as are needed."""
    frames = bag.of_type(*TRANSFORMS)
    first, begun_s = _FirstMessages(path, odometry, has_frames=bool(frames)), None
    for message in bag.messages(scans, *filter(None, [odometry]), *frames):
        begun_s = message.recorded_s if begun_s is None else begun_s
        first.take(message)
        late = message.recorded_s - begun_s > _LOOKED_AT_S
        if first.sweeps and (late or first.are_enough):
            break
    if not first.sweeps:
        raise InputError(f"{named(path)}: no message of {scans} in it")
    return first.sweeps, first.poses, first.tree


class _FirstMessages:
    """What the first messages of a bag say: scans, poses of its topic of odometry, and frames."""

    def __init__(self, path: Path, odometry: str, *, has_frames: bool) -> None:
        self.sweeps: list[SaidScan] = []
        self.poses, self.tree = Poses(source=odometry), FrameTree()
        self._path, self._odometry, self._has_frames = path, odometry, has_frames

    def take(self, message: Message) -> None:
        """Take a message of any of the three kinds."""
        kind = message.content.__msgtype__
        if kind in TRANSFORMS:
            self.tree.add(message)
            return
        with as_defined(named(self._path)):
            if kind == ODOMETRY:
                self.poses.add(message.content, message.recorded_s)
            elif len(self.sweeps) < _ENOUGH:
                self.sweeps.append(SaidScan.said_by(message.content, message.recorded_s))

    @property
    def are_enough(self) -> bool:
        """Whether there are enough scans and poses to compare, and the laser's place on the robot is known."""
        if len(self.sweeps) < _ENOUGH:
            return False
        frame = self.sweeps[0].frame
        told = self.poses if self._odometry else odometry_of_frames(self.tree, frame)
        if told is None:
            return not self._has_frames
        return len(told.poses) >= _ENOUGH and (not self._has_frames or self.tree.between(told.robot, frame) is not None)


class StreamedScan(NamedTuple):
    """A scan out of a stream.

    Attributes:
        message: As it came.
        time_ns: When it was recorded [ns].
        scan: What it says.
        order: (N,) which reading of the message each beam of the scan is.
        odometry: (3,) T_odom_robot at its time, the first pose of the odometry being the origin; None: not known.
        newest: Time [s] and pose (3,) of the newest odometry that had come; None: none.
    """

    message: Any
    time_ns: int
    scan: LaserScan
    order: NDArray[np.intp]
    odometry: Array | None
    newest: tuple[float, Array] | None = None


class ScanStream:
    """Puts odometry to scans while the messages of a bag come, one after the other.

    A scan waits until odometry after it has come, for half a second at most.

    Args:
        beginning: What the bag has.
    """

    def __init__(self, beginning: BagBeginning) -> None:
        self._bag, self._where = beginning, f"{named(beginning.path)}: {beginning.scans}"
        self._waiting: deque[tuple[Any, int, SaidScan]] = deque()
        self._odometry = _RecentOdometry()
        self._reach = 0.0

    def take(self, topic: str, kind: str, time_ns: int, raw: bytes) -> Iterator[StreamedScan]:
        """Take a message, recorded at `time_ns` [ns]; yield the scans whose odometry is known now."""
        bag, recorded_s = self._bag, 1e-9 * time_ns
        if topic == bag.scans:
            with as_defined(self._where), np.errstate(invalid="ignore"):
                content = bag.types.read(raw, kind)
                self._waiting.append((content, time_ns, SaidScan.said_by(content, recorded_s)))
        elif topic == bag.odometry or (bag.moving and kind in TRANSFORMS):
            with as_defined(f"{named(bag.path)}: {topic}"):
                self._take_motion(bag.types.read(raw, kind), recorded_s)
        while self._waiting and self._is_ready(self._waiting[0][2], recorded_s):
            yield self._placed(*self._waiting.popleft())

    def rest(self) -> Iterator[StreamedScan]:
        """Yield the scans that still wait."""
        while self._waiting:
            yield self._placed(*self._waiting.popleft())

    def _take_motion(self, content: Any, recorded_s: float) -> None:
        bag = self._bag
        if bag.odometry:
            pose = content.pose.pose
            place = planar(pose.position, rotation_matrix(pose.orientation))
            self._odometry.add(stamp_s(content.header) if bag.by_header else recorded_s, place)
            return
        for each in content.transforms:
            if (frame_name(each.header.frame_id), frame_name(each.child_frame_id)) == bag.moving:
                move = each.transform
                place = planar(move.translation, rotation_matrix(move.rotation))
                self._odometry.add(stamp_s(each.header) if bag.by_header else recorded_s, place)

    def _time(self, sweep: SaidScan) -> float:
        return sweep.stamp_s if self._bag.by_header else sweep.recorded_s

    def _is_ready(self, sweep: SaidScan, now_s: float) -> bool:
        late = now_s - sweep.recorded_s > _WAIT_S
        return late or not self._bag.has_odometry or self._odometry.newest_s >= self._time(sweep)

    def _placed(self, message: Any, time_ns: int, sweep: SaidScan) -> StreamedScan:
        bag, time_s = self._bag, self._time(sweep)
        here = np.max(sweep.ranges, initial=0.0, where=np.isfinite(sweep.ranges))
        self._reach = max(self._reach, float(here))
        scan, order = placed_scan(sweep, time_s, self._reach, bag.mount, bag.flipped, self._where)
        pose = self._odometry.at(time_s) if bag.has_odometry else None
        return StreamedScan(message, time_ns, scan, order, pose, self._odometry.newest)


class ReadAlready:
    """In place of a bag's `MessageTypes`: takes messages that are read already for their bytes."""

    def read(self, raw: Any, kind: str) -> Any:
        """Return the message."""
        return raw


class _RecentOdometry:
    """The newest poses of an odometry, seen from its first one."""

    def __init__(self) -> None:
        self._first: Array | None = None
        self._times_s: deque[float] = deque()
        self._poses: deque[Array] = deque()

    @property
    def newest_s(self) -> float:
        """Time of the newest pose [s]."""
        return self._times_s[-1] if self._times_s else -np.inf

    @property
    def newest(self) -> tuple[float, Array] | None:
        """Time [s] and pose (3,) of the newest one, if there is any."""
        return (self._times_s[-1], self._poses[-1]) if self._times_s else None

    def add(self, time_s: float, pose: Array) -> None:
        """Take a pose (3,); one that is not newer than the one before, or is none, says nothing."""
        if time_s > self.newest_s and np.isfinite(pose).all():
            self._first = pose if self._first is None else self._first
            self._times_s.append(time_s)
            self._poses.append(between(self._first, pose))

    def at(self, time_s: float) -> Array:
        """Return the pose (3,) at `time_s`, later than those asked for before; poses before it are forgotten."""
        while len(self._times_s) > 2 and self._times_s[1] <= time_s:
            self._times_s.popleft()
            self._poses.popleft()
        if not self._poses:
            return np.zeros(3)
        if len(self._poses) == 1:
            return self._poses[0]
        a, b = self._poses[0], self._poses[1]
        share = float(np.clip((time_s - self._times_s[0]) / (self._times_s[1] - self._times_s[0]), 0.0, 1.0))
        step = b - a
        step[2] = wrap_angle(step[2])
        return a + share * step
