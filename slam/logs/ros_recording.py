"""Writes drives, maps and people as one MCAP file of ROS 2 messages: for Foxglove, rerun, RViz and `ros2 bag play`."""

import os
import shutil
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError, shown
from ..files.output import replacing, require_writable
from ..occupancy_map import OccupancyMap
from ..scan import LaserScan
from .ros_messages import RosMessages, nanoseconds
from .viewer_recording import CAMERA, LASER, MAP, ODOM, ROBOT, ViewerRecording

_TYPES = {
    "scan": "sensor_msgs/msg/LaserScan",
    "odometry": "nav_msgs/msg/Odometry",
    "transform": "tf2_msgs/msg/TFMessage",
    "stamped_pose": "geometry_msgs/msg/PoseStamped",
    "path": "nav_msgs/msg/Path",
    "map": "nav_msgs/msg/OccupancyGrid",
    "people": "visualization_msgs/msg/MarkerArray",
    "picture": "sensor_msgs/msg/Image",
    "camera_info": "sensor_msgs/msg/CameraInfo",
    "twist": "geometry_msgs/msg/Twist",
    "number": "std_msgs/msg/Float64",
}
"""Kind of message -> its type."""


class RosRecording(ViewerRecording):
    """One MCAP file, written message by message; it appears whole when it is closed, or not at all.

    Example: `with RosRecording("drive.mcap") as recording: recording.scan(scan)`. Equal calls give equal bytes.

    Args:
        path: Of the file, ending in .mcap.

    Raises:
        InputError: If the name ends otherwise, or nothing can be written there.
        MissingExtraError: If `rosbags` is not installed.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self._messages = check_ros_recording(path)
        super().__init__(path)
        self.file.parent.mkdir(parents=True, exist_ok=True)
        self._folder = Path(tempfile.mkdtemp(prefix=f".{self.file.stem[:20]}-", dir=self.file.parent))
        self._writer, self._qos = _open_writer(self._folder / "recording")
        self._connections: dict[str, Any] = {}

    def _finish(self, keep: bool) -> None:
        try:
            self._writer.close()
            if keep:
                with replacing(self.file) as temporary:
                    os.replace(next((self._folder / "recording").glob("*.mcap")), temporary)
        finally:
            shutil.rmtree(self._folder, ignore_errors=True)

    def _write_scan(self, time_s: float, scan: LaserScan, topic: str) -> None:
        self._write(topic, "scan", time_s, lambda make: make.scan(scan, time_s, LASER))

    def odometry(self, time_s: float, pose: ArrayLike, velocity: ArrayLike = (0.0, 0.0, 0.0)) -> None:
        """Write odometry, T_odom_robot (3,), to `/odom` and to the tree of frames."""
        frames = (ODOM, ROBOT)
        self._write("/odom", "odometry", time_s, lambda make: make.odometry(pose, velocity, time_s, frames))
        self.transform(time_s, pose, ODOM, ROBOT)

    def transform(self, time_s: float, pose: ArrayLike, parent: str, child: str, *, fixed: bool = False) -> None:
        """Write where a frame is in its parent, (3,); `fixed` for good."""
        topic = "/tf_static" if fixed else "/tf"
        self._write(topic, "transform", time_s, lambda make: make.transform(pose, time_s, (parent, child)))

    def pose(self, time_s: float, pose: ArrayLike, topic: str, frame: str = MAP) -> None:
        """Write a pose (3,) in a frame."""
        self._write(topic, "stamped_pose", time_s, lambda make: make.stamped_pose(pose, time_s, frame))

    def way(self, time_s: float, poses: NDArray[np.float64], topic: str = "/path", frame: str = MAP) -> None:
        """Write a way, (n, 3) poses in a frame."""
        self._write(topic, "path", time_s, lambda make: make.path(poses, time_s, frame))

    def map(self, time_s: float, grid: OccupancyMap, topic: str = "/map") -> None:
        """Write a map."""
        self._write(topic, "map", time_s, lambda make: make.map(grid, time_s, MAP))

    def _write_people(
        self, time_s: float, places: NDArray[np.float64], numbers: Sequence[int], leader: int, topic: str, frame: str
    ) -> None:
        self._write(topic, "people", time_s, lambda make: make.people(places, numbers, leader, time_s, frame))

    def picture(self, time_s: float, pixels: NDArray[Any], topic: str) -> None:
        """Write a picture: (h, w, 3) uint8 in colour, or (h, w) depths [m]."""
        self._write(topic, "picture", time_s, lambda make: make.picture(pixels, time_s, CAMERA))

    def command(self, time_s: float, velocity: ArrayLike) -> None:
        """Write a commanded velocity (forward, left, turn) to `/cmd_vel`."""
        self._write("/cmd_vel", "twist", time_s, lambda make: make.twist(velocity))

    def number(self, time_s: float, value: float, topic: str) -> None:
        """Write one number, such as a reward."""
        self._write(topic, "number", time_s, lambda make: make.make("std_msgs/Float64", data=float(value)))

    def _write(self, topic: str, kind: str, time_s: float, make: Callable[[RosMessages], Any]) -> None:
        self._require_open()
        message, name = make(self._messages), _TYPES[kind]
        if topic not in self._connections:
            qos = [self._qos] if topic in ("/tf_static", "/map") else []
            self._connections[topic] = self._writer.add_connection(
                topic, name, typestore=self._messages.store, offered_qos_profiles=qos
            )
        data = self._messages.store.serialize_cdr(message, name)
        self._writer.write(self._connections[topic], nanoseconds(time_s), data)


def check_ros_recording(path: str | os.PathLike[str]) -> RosMessages:
    """Make sure that a recording could be written to `path`, before hours of work are spent on it.

    Raises:
        InputError: If the name does not end in .mcap, or nothing can be written there.
        MissingExtraError: If `rosbags` is not installed.
    """
    if Path(path).suffix != ".mcap":
        raise InputError(f"{shown(Path(path))}: a recording for ROS 2 is called FILE.mcap")
    require_writable(path)
    return RosMessages()


def _open_writer(folder: Path) -> tuple[Any, Any]:
    """Return the library's writer, open, and the quality of service of what who comes late must see, too."""
    from rosbags.interfaces import (
        Qos,
        QosDurability,
        QosHistory,
        QosLiveliness,
        QosReliability,
        QosTime,
    )
    from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer

    writer = Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP)
    writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
    writer.open()
    never = QosTime(2147483647, 4294967295)
    latched = Qos(
        QosHistory.KEEP_LAST, 1, QosReliability.RELIABLE, QosDurability.TRANSIENT_LOCAL, never, never,
        QosLiveliness.AUTOMATIC, never, False,
    )  # fmt: skip
    return writer, latched
