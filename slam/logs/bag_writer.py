"""Writes a drive as a ROS 1 bag, so that others can run their own SLAM on it."""

import os
from typing import Any

import numpy as np

from ..errors import MissingExtraError
from ..files.output import replacing
from ..scan import LaserScan
from .carmen_writer import angular_step
from .drive import RecordedDrive
from .message_types import MessageTypes

SCAN, ODOMETRY, TRANSFORMS = "sensor_msgs/msg/LaserScan", "nav_msgs/msg/Odometry", "tf2_msgs/msg/TFMessage"
_FRAMES = "odom", "base_link", "laser"


def write_rosbag(path: str | os.PathLike[str], drive: RecordedDrive) -> None:
    """Write `drive` with topics /scan, /odom and /tf (odom to base_link to laser), whole or not at all.

    "No return" is infinity, "no measurement" NaN (REP 117). Stamps are those of the scans.

    Raises:
        InputError: If the beams of a scan are not evenly spaced.
        MissingExtraError: If `rosbags` is not installed.
    """
    try:
        from rosbags.rosbag1 import Writer
    except ImportError:
        raise MissingExtraError("ROS bags", "ros") from None
    types = MessageTypes(ros1=True)
    make = _Messages(types)
    with replacing(path) as temporary:
        temporary.unlink()  # the library makes its own
        with Writer(temporary) as writer:
            topics = {}
            for topic, kind in (("/tf", TRANSFORMS), ("/odom", ODOMETRY), ("/scan", SCAN)):
                text, digest = types.definition(kind)
                topics[topic] = writer.add_connection(topic, kind, msgdef=text, md5sum=digest)
            for number, (pose, scan) in enumerate(zip(drive.odometry.tolist(), drive.scans, strict=True)):
                content = {
                    "/tf": (TRANSFORMS, make.transforms(scan, pose)),
                    "/odom": (ODOMETRY, make.odometry(scan, pose)),
                    "/scan": (SCAN, make.scan(scan, number)),
                }
                for topic, (kind, message) in content.items():
                    writer.write(topics[topic], round(scan.time_s * 1e9), types.write(message, kind))


class _Messages:
    def __init__(self, types: MessageTypes) -> None:
        self._make = types.make

    def scan(self, scan: LaserScan, number: int) -> Any:
        """Return a `LaserScan` message; `number` names the scan in errors."""
        ranges = np.where(scan.is_no_return, np.inf, np.where(scan.is_return, scan.ranges, np.nan))
        return self._make(
            SCAN,
            header=self._header(scan.time_s, _FRAMES[2]),
            angle_min=float(scan.bearings[0]),
            angle_max=float(scan.bearings[-1]),
            angle_increment=angular_step(scan, number),
            time_increment=0.0,
            scan_time=0.0,
            range_min=float(scan.range_min),
            range_max=float(scan.range_max),
            ranges=ranges.astype(np.float32),
            intensities=np.zeros(0, dtype=np.float32),
        )

    def odometry(self, scan: LaserScan, pose: list[float]) -> Any:
        """Return an `Odometry` message with T_odom_robot (3,)."""
        nothing = self._make("geometry_msgs/msg/Vector3", x=0.0, y=0.0, z=0.0)
        place = self._make(
            "geometry_msgs/msg/Pose",
            position=self._make("geometry_msgs/msg/Point", x=pose[0], y=pose[1], z=0.0),
            orientation=self._turn(pose[2]),
        )
        return self._make(
            ODOMETRY,
            header=self._header(scan.time_s, _FRAMES[0]),
            child_frame_id=_FRAMES[1],
            pose=self._make("geometry_msgs/msg/PoseWithCovariance", pose=place, covariance=np.zeros(36)),
            twist=self._make(
                "geometry_msgs/msg/TwistWithCovariance",
                twist=self._make("geometry_msgs/msg/Twist", linear=nothing, angular=nothing),
                covariance=np.zeros(36),
            ),
        )

    def transforms(self, scan: LaserScan, pose: list[float]) -> Any:
        """Return a `TFMessage` from the odometry's frame to the laser's."""
        poses = (pose, scan.T_robot_lidar)
        links = [
            self._make(
                "geometry_msgs/msg/TransformStamped",
                header=self._header(scan.time_s, parent),
                child_frame_id=child,
                transform=self._make(
                    "geometry_msgs/msg/Transform",
                    translation=self._make("geometry_msgs/msg/Vector3", x=float(x), y=float(y), z=0.0),
                    rotation=self._turn(theta),
                ),
            )
            for parent, child, (x, y, theta) in zip(_FRAMES[:2], _FRAMES[1:], poses, strict=True)
        ]
        return self._make(TRANSFORMS, transforms=links)

    def _header(self, time_s: float, frame: str) -> Any:
        nanoseconds = round(time_s * 1e9)
        stamp = self._make(
            "builtin_interfaces/msg/Time", sec=nanoseconds // 1_000_000_000, nanosec=nanoseconds % 1_000_000_000
        )
        return self._make("std_msgs/msg/Header", seq=0, stamp=stamp, frame_id=frame)

    def _turn(self, theta: float) -> Any:
        z, w = float(np.sin(0.5 * theta)), float(np.cos(0.5 * theta))
        return self._make("geometry_msgs/msg/Quaternion", x=0.0, y=0.0, z=z, w=w)
