"""People and legs of a scan as standard ROS messages, in the frame of the laser."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...slam.geometry import inverse, transform_points
from ...slam.logs.message_types import MessageTypes
from ..people_filter import FilteredScan, points_lidar

Array = NDArray[np.float64]

POSES, CLOUD = "geometry_msgs/msg/PoseArray", "sensor_msgs/msg/PointCloud2"
_FLOAT32, _UINT32 = 7, 6  # sensor_msgs/PointField
_COLUMNS = {"x": "<f4", "y": "<f4", "z": "<f4", "id": "<u4", "vx": "<f4", "vy": "<f4", "confidence": "<f4"}


class PeopleMessages:
    """Writes messages about the people in scans of one laser.

    Args:
        types: Of messages.
        flipped: Whether the laser hangs upside down; then its y and its angles go the other way.
    """

    def __init__(self, types: MessageTypes, *, flipped: bool) -> None:
        self._types, self._mirror = types, np.array([1.0, -1.0 if flipped else 1.0])

    def people(self, header: Any, filtered: FilteredScan) -> Any:
        """Return a `PoseArray`: where each person is, x along the way that it walks."""
        ways = self._velocities(filtered)
        return self._poses(header, self._positions(filtered), np.arctan2(ways[:, 1], ways[:, 0]))

    def tracks(self, header: Any, filtered: FilteredScan) -> Any:
        """Return a `PointCloud2` of people, in the same order: x, y, z [m], id, vx, vy [m/s], confidence in [0, 1]."""
        rows = np.zeros(len(filtered.people), dtype=np.dtype(list(_COLUMNS.items())))
        rows["x"], rows["y"] = self._positions(filtered).T
        rows["vx"], rows["vy"] = self._velocities(filtered).T
        rows["id"], rows["confidence"] = filtered.people.ids, filtered.people.confidence
        fields = [
            self._types.make(
                "sensor_msgs/msg/PointField",
                name=name,
                offset=4 * number,
                datatype=_UINT32 if kind == "<u4" else _FLOAT32,
                count=1,
            )
            for number, (name, kind) in enumerate(_COLUMNS.items())
        ]
        return self._types.make(
            CLOUD,
            header=header,
            height=1,
            width=len(rows),
            fields=fields,
            is_bigendian=False,
            point_step=rows.itemsize,
            row_step=rows.nbytes,
            data=np.frombuffer(rows.tobytes(), dtype=np.uint8),
            is_dense=True,
        )

    def legs(self, header: Any, filtered: FilteredScan) -> Any:
        """Return a `PoseArray`: where the legs of tracked people were seen in this scan."""
        seen = filtered.people.seen_legs
        places = points_lidar(filtered.scan, seen.positions[seen.owner >= 0], filtered.odometry)
        return self._poses(header, places * self._mirror, np.zeros(len(places)))

    def _positions(self, filtered: FilteredScan) -> Array:
        return points_lidar(filtered.scan, filtered.people.positions, filtered.odometry) * self._mirror

    def _velocities(self, filtered: FilteredScan) -> Array:
        turn = filtered.odometry[2] + filtered.scan.T_robot_lidar[2]
        return transform_points(inverse(np.array([0.0, 0.0, turn])), filtered.people.velocities) * self._mirror

    def _poses(self, header: Any, places: Array, headings: Array) -> Any:
        make = self._types.make
        poses = [
            make(
                "geometry_msgs/msg/Pose",
                position=make("geometry_msgs/msg/Point", x=x, y=y, z=0.0),
                orientation=make(
                    "geometry_msgs/msg/Quaternion", x=0.0, y=0.0, z=np.sin(0.5 * heading), w=np.cos(0.5 * heading)
                ),
            )
            for (x, y), heading in zip(places.tolist(), headings.tolist(), strict=True)
        ]
        return make(POSES, header=header, poses=poses)
