"""Scans as they come on a robot, each with the odometry at its time and the laser's place on the robot."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...slam.bounds import check_mount, check_words
from ...slam.drives.live_deskewing import Deskewer
from ...slam.drives.sweep_time import SweepTime
from ...slam.errors import InputError, shown
from ...slam.geometry import compose
from ...slam.logs.bag_messages import Message, as_defined
from ...slam.logs.ros_frames import FrameTree, frame_name, planar, rotation_matrix, stamp_s
from ...slam.logs.rosbag import laser_mount
from ...slam.logs.scan_stream import BagBeginning, ReadAlready, ScanStream, StreamedScan
from ...slam.scan import LaserScan
from .outputs import FRAMES, ODOMETRY, SCAN

Array = NDArray[np.float64]

FIND, AT_ONCE = "find", "at-once"
"""When the beams of a scan are measured: the scans say it; all at once."""


@dataclass(frozen=True, kw_only=True)
class InputConfig:
    """What every node has to know of what it listens to.

    Attributes:
        laser_pose: x, y [m], theta [rad] of the laser on the robot; none: as the frames of /tf_static say, which scans
            wait for.
        by_header: Whether times are those of the message headers; else those of their arrival, for robots whose parts
            do not agree about the time.
        sweep: When the beams of a scan are measured: "find" (the scans of the first turns say), "at-once", or a share
            of the time between scans that a turn of the laser takes and words of `SweepTime`, such as "1.0 clockwise".
    """

    laser_pose: tuple[float, ...] = ()
    by_header: bool = True
    sweep: str = FIND

    def __post_init__(self) -> None:
        check_words(self)
        if not isinstance(self.laser_pose, tuple) or len(self.laser_pose) not in (0, 3):
            raise InputError(f"laser_pose must be x, y, theta, or nothing, got {shown(self.laser_pose)}")
        if self.laser_pose:
            check_mount(self.laser_pose, "laser_pose")
        self.deskewer()

    def deskewer(self) -> Deskewer | None:
        """Return what takes the robot's motion out of the scans; None: nothing is to."""
        return None if self.sweep == AT_ONCE else Deskewer(None if self.sweep == FIND else self.sweep)


class LiveScan(NamedTuple):
    """A scan with all that is known of it.

    Attributes:
        message: As it came.
        scan: What it says, as if measured at once.
        order: (N,) which reading of the message each beam of the scan is.
        odometry: (3,) the robot at its time, seen from where the odometry began.
        T_odom_robot: (3,) the same in the odometry's own frame.
        flipped: Whether the laser hangs upside down.
        odometry_s: Time of the newest odometry, no later than when it came [s].
    """

    message: Any
    scan: LaserScan
    order: NDArray[np.intp]
    odometry: Array
    T_odom_robot: Array
    flipped: bool
    odometry_s: float


class LiveScans:
    """Puts odometry to scans as messages come; the same that `tagalong filter` does for a bag.

    Scans of a laser that spins lose the robot's motion (`Deskewer`), from when its first turns have shown it.

    A scan waits until odometry after it has come, for half a second at most. Before the laser's place on the robot is
    known, and where no odometry comes, scans are passed over. One that is not newer than the one before is, too.
    """

    def __init__(self, config: InputConfig) -> None:
        self._config, self._tree = config, FrameTree()
        self._stream: ScanStream | None = None
        self._robot, self._odom_frame = "", ""
        self._first: Array | None = None
        self._heard: list[tuple[Any, int]] = []
        self._odometry_s = self._newest_s = -np.inf
        self._flipped = False
        self._deskewer, self._said, self._notes = config.deskewer(), None, list[str]()

    def notes(self) -> list[str]:
        """Return what has been found out since the last call, a sentence each."""
        notes, self._notes = self._notes, []
        return notes

    @property
    def odom_frame(self) -> str:
        """The odometry's frame, "" before it is known."""
        return self._odom_frame

    def take(self, source: str, message: Any, now_s: float) -> list[LiveScan]:
        """Take a message that came at `now_s` [s]; return the scans whose odometry is known now.

        Raises:
            InputError: If it is not what its type says.
        """
        if source == FRAMES:
            self._tree.add(Message(now_s, message))
            return []
        if source == ODOMETRY:
            self._look_at_odometry(message, now_s)
        elif source == SCAN and self._stream is None:
            self._begin(message)
        if self._stream is None:
            return []
        taken = self._stream.take(source, "", round(1e9 * now_s), message)
        return [self._placed(one) for one in taken if self._is_next(one.scan)]

    def _look_at_odometry(self, message: Any, now_s: float) -> None:
        with as_defined(ODOMETRY):
            self._robot, self._odom_frame = frame_name(message.child_frame_id), frame_name(message.header.frame_id)
            time_s = stamp_s(message.header) if self._config.by_header else now_s
            pose = planar(message.pose.pose.position, rotation_matrix(message.pose.pose.orientation))
        if np.isfinite(pose).all():
            self._odometry_s = max(self._odometry_s, min(time_s, now_s))
            self._first = pose if self._first is None or self._stream is None else self._first
            self._heard = [(message, round(1e9 * now_s))]

    def _begin(self, message: Any) -> None:
        """Start with the first scan whose laser's place on the robot is known."""
        with as_defined(SCAN):
            frame = frame_name(message.header.frame_id)
        place, notes = tuple(self._config.laser_pose), []
        if not place:
            place, self._flipped = laser_mount(self._tree, self._robot or None, frame, notes, Path(FRAMES))
        if notes and frame != self._robot:
            return
        x, y, theta = place
        self._stream = ScanStream(
            BagBeginning(
                path=Path("ROS"),
                topics={},
                scans=SCAN,
                odometry=ODOMETRY,
                moving=None,
                mount=(x, y, theta),
                flipped=self._flipped,
                by_header=self._config.by_header,
                notes=(),
                types=ReadAlready(),  # pyright: ignore[reportArgumentType]
            )
        )
        for heard, time_ns in self._heard:  # the stream counts from the newest odometry before it
            list(self._stream.take(ODOMETRY, "", time_ns, heard))

    def _is_next(self, scan: LaserScan) -> bool:
        newer = scan.time_s > self._newest_s
        self._newest_s = max(self._newest_s, scan.time_s)
        return newer and self._first is not None

    def _placed(self, one: StreamedScan) -> LiveScan:
        assert self._first is not None
        assert one.odometry is not None
        whole, scan, order = compose(self._first, one.odometry), one.scan, one.order
        if self._deskewer is not None:
            scan, beams = self._deskewer.update(one.odometry, scan, one.newest)
            order = order[beams]
            self._note(self._deskewer.sweep)
        return LiveScan(one.message, scan, order, one.odometry, whole, self._flipped, self._odometry_s)

    def _note(self, sweep: SweepTime | None) -> None:
        if sweep not in (None, self._said) and self._config.sweep == FIND:
            self._notes.append(f"{sweep.note}; it need not be found again with sweep:='{sweep.words}'")
            self._said = sweep
