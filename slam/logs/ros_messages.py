"""Messages of ROS 2 made of scans, poses, maps and pictures: x forward, y left, z up, metres and radians (REP 103)."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from ..bounds import checked_pose
from ..errors import InputError, MissingExtraError
from ..occupancy_map import OccupancyMap
from ..scan import LaserScan

_EVEN_RAD = 1e-4  # off its place between the first and the last one, a beam of an evenly spaced scan may lie so far
_LATEST_S = 2.0**31  # a stamp has 32 bits for its seconds
PERSON_HEIGHT_M, PERSON_WIDTH_M = 1.7, 0.45
"""Of the cylinder that stands for a person in a viewer."""
PERSON_COLOUR, LEADER_COLOUR = (0.95, 0.55, 0.1), (0.1, 0.7, 0.3)


class RosMessages:
    """Makes messages of ROS 2 (Humble's definitions, which later ones share).

    Raises:
        MissingExtraError: If `rosbags` is not installed.
    """

    def __init__(self) -> None:
        try:
            from rosbags.typesys import Stores, get_typestore
        except ImportError:
            raise MissingExtraError("recordings for ROS 2", "ros") from None
        self.store: Any = get_typestore(Stores.ROS2_HUMBLE)

    def make(self, kind: str, **content: Any) -> Any:
        """Return a message of a type, such as "std_msgs/msg/Float64"."""
        package, _, name = kind.partition("/")
        return self.store.types[f"{package}/msg/{name.removeprefix('msg/')}"](**content)

    def header(self, time_s: float, frame: str) -> Any:
        """Return a header.

        Raises:
            InputError: If the time is negative or beyond what a stamp can hold.
        """
        return self.make("std_msgs/Header", stamp=self._time(time_s), frame_id=frame)

    def scan(self, scan: LaserScan, time_s: float, frame: str) -> Any:
        """Return a LaserScan; no return is `inf` and no measurement NaN (REP 117).

        The message knows evenly spaced beams alone: of others, each of as many even ones gets what the nearest says.

        Raises:
            InputError: If there are no beams.
        """
        if not len(scan):
            raise InputError("a scan for ROS needs beams; this one has none")
        step = float(scan.bearings[-1] - scan.bearings[0]) / max(len(scan) - 1, 1)
        ranges = np.where(scan.is_no_return, np.inf, np.where(scan.is_return, scan.ranges, np.nan))
        even = scan.bearings[0] + step * np.arange(len(scan))
        if np.abs(scan.bearings - even).max() > _EVEN_RAD:
            ranges = ranges[np.searchsorted(0.5 * (scan.bearings[1:] + scan.bearings[:-1]), even)]
        return self.make(
            "sensor_msgs/LaserScan",
            header=self.header(time_s, frame),
            angle_min=float(scan.bearings[0]),
            angle_max=float(scan.bearings[-1]),
            angle_increment=step,
            time_increment=0.0,
            scan_time=0.0,
            range_min=float(scan.range_min),
            range_max=float(scan.range_max),
            ranges=ranges.astype(np.float32),
            intensities=np.zeros(0, dtype=np.float32),
        )

    def pose(self, pose: ArrayLike) -> Any:
        """Return a Pose of (x, y, theta)."""
        x, y, theta = checked_pose(pose, "pose").tolist()
        return self.make("geometry_msgs/Pose", position=self._point(x, y), orientation=self._turn(theta))

    def stamped_pose(self, pose: ArrayLike, time_s: float, frame: str) -> Any:
        """Return a PoseStamped."""
        return self.make("geometry_msgs/PoseStamped", header=self.header(time_s, frame), pose=self.pose(pose))

    def twist(self, velocity: ArrayLike) -> Any:
        """Return a Twist of (forward, left, turn) [m/s, m/s, rad/s]."""
        forward, left, turn = np.asarray(velocity, dtype=np.float64).tolist()
        return self.make(
            "geometry_msgs/Twist", linear=self._vector(forward, left), angular=self._vector(0.0, 0.0, turn)
        )

    def odometry(self, pose: ArrayLike, velocity: ArrayLike, time_s: float, frames: tuple[str, str]) -> Any:
        """Return an Odometry; `frames` are (parent, child)."""
        nothing = np.zeros(36)
        return self.make(
            "nav_msgs/Odometry",
            header=self.header(time_s, frames[0]),
            child_frame_id=frames[1],
            pose=self.make("geometry_msgs/PoseWithCovariance", pose=self.pose(pose), covariance=nothing),
            twist=self.make("geometry_msgs/TwistWithCovariance", twist=self.twist(velocity), covariance=nothing),
        )

    def transform(self, pose: ArrayLike, time_s: float, frames: tuple[str, str]) -> Any:
        """Return a TFMessage of one transform; `frames` are (parent, child)."""
        x, y, theta = checked_pose(pose, "pose").tolist()
        return _transformed(self, self._vector(x, y), self._turn(theta), time_s, frames)

    def mount(self, T_parent_child: NDArray[np.float64], time_s: float, frames: tuple[str, str]) -> Any:
        """Return a TFMessage of where a frame is in space, (4, 4), in its parent; `frames` are (parent, child)."""
        x, y, z, w = Rotation.from_matrix(T_parent_child[:3, :3]).as_quat().tolist()
        turn = self.make("geometry_msgs/Quaternion", x=x, y=y, z=z, w=w)
        return _transformed(self, self._vector(*T_parent_child[:3, 3].tolist()), turn, time_s, frames)

    def camera_info(
        self, size: tuple[int, int], focal: tuple[float, float], centre: tuple[float, float], time_s: float, frame: str
    ) -> Any:
        """Return a CameraInfo of a camera without distortion: columns and rows, fx and fy, cx and cy [pixels]."""
        (fx, fy), (cx, cy) = focal, centre
        roi = self.make("sensor_msgs/RegionOfInterest", x_offset=0, y_offset=0, height=0, width=0, do_rectify=False)
        return self.make(
            "sensor_msgs/CameraInfo",
            header=self.header(time_s, frame),
            height=size[1],
            width=size[0],
            distortion_model="plumb_bob",
            d=np.zeros(5),
            k=np.array([fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0]),
            r=np.eye(3).reshape(-1),
            p=np.array([fx, 0.0, cx, 0.0, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0]),
            binning_x=0,
            binning_y=0,
            roi=roi,
        )

    def path(self, poses: NDArray[np.float64], time_s: float, frame: str) -> Any:
        """Return a Path of (n, 3) poses."""
        stamped = [self.stamped_pose(pose, time_s, frame) for pose in poses]
        return self.make("nav_msgs/Path", header=self.header(time_s, frame), poses=stamped)

    def map(self, grid: OccupancyMap, time_s: float, frame: str) -> Any:
        """Return an OccupancyGrid: 0 .. 100 is the probability in percent, -1 unknown."""
        rows, cols = grid.probability.shape
        percent = np.where(grid.known, np.round(100.0 * np.nan_to_num(grid.probability)), -1.0).astype(np.int8)
        info = self.make(
            "nav_msgs/MapMetaData",
            map_load_time=self._time(time_s),
            resolution=float(grid.resolution),
            width=cols,
            height=rows,
            origin=self.pose((*grid.origin, 0.0)),
        )
        return self.make(
            "nav_msgs/OccupancyGrid", header=self.header(time_s, frame), info=info, data=percent.reshape(-1)
        )

    def people(self, positions: NDArray[np.float64], ids: Sequence[int], leader: int, time_s: float, frame: str) -> Any:
        """Return a MarkerArray: those of before are cleared, then a cylinder for each of `positions` (n, 2)."""
        markers = [self._marker(time_s, frame, action=3)]
        for position, number in zip(positions.tolist(), ids, strict=True):
            colour = LEADER_COLOUR if number == leader else PERSON_COLOUR
            markers.append(self._marker(time_s, frame, number=int(number), position=position, colour=colour))
        return self.make("visualization_msgs/MarkerArray", markers=markers)

    def picture(self, pixels: NDArray[Any], time_s: float, frame: str) -> Any:
        """Return an Image of (h, w, 3) uint8 (rgb8), or of (h, w) float32 [m] (32FC1)."""
        colour = pixels.ndim == 3
        kept = np.ascontiguousarray(pixels, dtype=np.uint8 if colour else "<f4")
        return self.make(
            "sensor_msgs/Image",
            header=self.header(time_s, frame),
            height=kept.shape[0],
            width=kept.shape[1],
            encoding="rgb8" if colour else "32FC1",
            is_bigendian=0,
            step=kept.strides[0],
            data=np.frombuffer(kept.tobytes(), dtype=np.uint8),
        )

    def _marker(
        self,
        time_s: float,
        frame: str,
        *,
        action: int = 0,
        number: int = 0,
        position: Sequence[float] = (0.0, 0.0),
        colour: tuple[float, float, float] = PERSON_COLOUR,
    ) -> Any:
        pose = self.make(
            "geometry_msgs/Pose",
            position=self._point(position[0], position[1], PERSON_HEIGHT_M / 2.0),
            orientation=self._turn(0.0),
        )
        size = self._vector(PERSON_WIDTH_M, PERSON_WIDTH_M, PERSON_HEIGHT_M)
        empty = self.make("std_msgs/Header", stamp=self._time(0.0), frame_id="")
        nothing = np.zeros(0, dtype=np.uint8)
        return self.make(
            "visualization_msgs/Marker",
            header=self.header(time_s, frame),
            ns="people",
            id=number,
            type=3,
            action=action,
            pose=pose,
            scale=size,
            color=self.make("std_msgs/ColorRGBA", r=colour[0], g=colour[1], b=colour[2], a=0.8),
            lifetime=self.make("builtin_interfaces/Duration", sec=0, nanosec=0),
            frame_locked=False,
            points=[],
            colors=[],
            texture_resource="",
            texture=self.make("sensor_msgs/CompressedImage", header=empty, format="", data=nothing),
            uv_coordinates=[],
            text="",
            mesh_resource="",
            mesh_file=self.make("visualization_msgs/MeshFile", filename="", data=nothing),
            mesh_use_embedded_materials=False,
        )

    def _time(self, time_s: float) -> Any:
        if not 0.0 <= time_s < _LATEST_S:  # no NaN is
            raise InputError(f"a time for ROS must be within 0 .. {_LATEST_S:.0f} s, got {time_s}")
        return self.make(
            "builtin_interfaces/Time", sec=nanoseconds(time_s) // 10**9, nanosec=nanoseconds(time_s) % 10**9
        )

    def _point(self, x: float, y: float, z: float = 0.0) -> Any:
        return self.make("geometry_msgs/Point", x=x, y=y, z=z)

    def _vector(self, x: float, y: float, z: float = 0.0) -> Any:
        return self.make("geometry_msgs/Vector3", x=x, y=y, z=z)

    def _turn(self, theta: float) -> Any:
        return self.make(
            "geometry_msgs/Quaternion", x=0.0, y=0.0, z=float(np.sin(theta / 2.0)), w=float(np.cos(theta / 2.0))
        )


def nanoseconds(time_s: float) -> int:
    """Return a time in whole nanoseconds."""
    return round(time_s * 1e9)


def pose_with_covariance(
    messages: RosMessages, pose: ArrayLike, covariance: NDArray[np.float64], time_s: float, frame: str
) -> Any:
    """Return a PoseWithCovarianceStamped; `covariance` (3, 3) is that of (x, y, theta)."""
    whole = np.zeros((6, 6))  # of x, y, z and turns about them
    whole[np.ix_((0, 1, 5), (0, 1, 5))] = covariance
    known = messages.make("geometry_msgs/PoseWithCovariance", pose=messages.pose(pose), covariance=whole.reshape(-1))
    return messages.make("geometry_msgs/PoseWithCovarianceStamped", header=messages.header(time_s, frame), pose=known)


def _transformed(make: RosMessages, place: Any, turn: Any, time_s: float, frames: tuple[str, str]) -> Any:
    """Return a TFMessage of one transform, a Vector3 and a Quaternion; `frames` are (parent, child)."""
    stamped = make.make(
        "geometry_msgs/TransformStamped",
        header=make.header(time_s, frames[0]),
        child_frame_id=frames[1],
        transform=make.make("geometry_msgs/Transform", translation=place, rotation=turn),
    )
    return make.make("tf2_msgs/TFMessage", transforms=[stamped])
