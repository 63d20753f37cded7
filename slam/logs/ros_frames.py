"""The tree of coordinate frames that `tf` messages tell."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .bag_messages import Message, as_defined

Array = NDArray[np.float64]


def stamp_s(header: Any) -> float:
    """Return the time [s] in a message header."""
    return header.stamp.sec + 1e-9 * header.stamp.nanosec


def frame_name(name: str) -> str:
    """Return a frame's name without the leading slash that old ROS allowed."""
    return name.lstrip("/")


def rotation_matrix(q: Any) -> Array:
    """Return the (3, 3) rotation of a quaternion message; the identity for the all-zero one that some drivers send."""
    v = np.array([q.x, q.y, q.z, q.w], dtype=np.float64)
    norm = np.linalg.norm(v)
    if not norm > 0.0:
        return np.eye(3)
    x, y, z, w = v / norm
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def planar(position: Any, rotation: Array) -> Array:
    """Return (3,) x, y [m] of a position message and the heading [rad] of a rotation (3, 3)."""
    return np.array([position.x, position.y, np.arctan2(rotation[1, 0], rotation[0, 0])])


@dataclass(eq=False)
class Track:
    """How a frame moved in its parent.

    Attributes:
        parent: Name of the parent.
        T_parent_child: (4, 4) at the first time.
        times_s: When, by the header.
        recorded_s: When, by the recorder.
        poses: (3,) each, in the plane.
    """

    parent: str
    T_parent_child: Array
    times_s: list[float] = field(default_factory=list)
    recorded_s: list[float] = field(default_factory=list)
    poses: list[Array] = field(default_factory=list)


class FrameTree:
    """Frames by name, each with its track in its parent.

    Args:
        messages: Of tf topics.
    """

    def __init__(self, messages: Iterable[Message] = ()) -> None:
        self._tracks: dict[str, Track] = {}
        for message in messages:
            self.add(message)

    def add(self, message: Message) -> None:
        """Take one more message."""
        with as_defined("a transform"):
            for each in message.content.transforms:
                self._add(each, message.recorded_s)

    def _add(self, stamped: Any, recorded_s: float) -> None:
        rotation = rotation_matrix(stamped.transform.rotation)
        move = stamped.transform.translation
        parent, child = frame_name(stamped.header.frame_id), frame_name(stamped.child_frame_id)
        track = self._tracks.get(child)
        if track is None or track.parent != parent:
            whole = np.eye(4)
            whole[:3, :3], whole[:3, 3] = rotation, (move.x, move.y, move.z)
            track = self._tracks[child] = Track(parent, whole)
        track.times_s.append(stamp_s(stamped.header))
        track.recorded_s.append(recorded_s)
        track.poses.append(planar(move, rotation))

    def upwards(self, frame: str) -> list[str]:
        """Return `frame`, its parent, and so on to the root."""
        names = {frame_name(frame): None}  # in order, each once
        last = frame_name(frame)
        while last in self._tracks and self._tracks[last].parent not in names:
            last = self._tracks[last].parent
            names[last] = None
        return list(names)

    def track(self, frame: str) -> Track:
        """Return how `frame` moved in its parent."""
        return self._tracks[frame]

    def between(self, base: str, frame: str) -> Array | None:
        """Return (4, 4) T_base_frame by the first transform of each link; None: they are not connected."""
        up_base, up_frame = self.upwards(base), self.upwards(frame)
        above = set(up_base)
        common = next((name for name in up_frame if name in above), None)
        if common is None:
            return None
        return np.asarray(
            np.linalg.solve(self._product(up_base, common), self._product(up_frame, common)), dtype=np.float64
        )

    def _product(self, names: list[str], top: str) -> Array:
        product = np.eye(4)
        for name in names[: names.index(top)]:
            product = self._tracks[name].T_parent_child @ product
        return product
