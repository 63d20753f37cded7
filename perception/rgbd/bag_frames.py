"""RGB-D frames of a ROS 1 or ROS 2 bag: depth pictures, each with the colour picture nearest in time.

Depth comes raw (`16UC1`, `mono16`, `32FC1`) or by compressed_depth_image_transport (PNG, RVL); colour raw or as JPEG or
PNG. Intrinsics are those of `camera_info`. Colour of a camera beside the depth's is brought to the pixels of depth
by tf.
"""

import os
from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...slam.errors import InputError
from ...slam.logs.bag_messages import Bag, as_defined, is_bag, open_bag
from ...slam.logs.ros_frames import FrameTree, frame_name, stamp_s
from ...slam.logs.rosbag import SCAN, TRANSFORMS
from .bag_topics import CameraTopics, choose_topics, has_depth
from .frame import Pinhole, RgbdFrame, grey
from .pictures import RecordedFrame
from .registration import registered_colour, turned_optical
from .ros_pictures import camera_of, colour_of, depth_of

Array = NDArray[np.float64]

_NEAR_S = 0.1
"""Colour that was taken earlier or later than depth by more than this is not of the same frame [s]."""
_WAIT_S = 1.0
"""So long, by the recorder's clock, depth waits for colour that may still come [s]."""


@dataclass(frozen=True, eq=False)
class _Taken:
    stamp_s: float
    recorded_s: float
    content: Any


def holds_frames_only(path: str | os.PathLike[str]) -> bool:
    """Return whether `path` is a bag with depth pictures and without scans."""
    if not is_bag(path):
        return False
    with open_bag(path) as bag:
        return not bag.of_type(SCAN) and has_depth(bag)


def has_frames(path: str | os.PathLike[str]) -> bool:
    """Return whether `path` is a bag with depth pictures."""
    if not is_bag(path):
        return False
    with open_bag(path) as bag:
        return has_depth(bag)


def read_bag_frames(
    path: str | os.PathLike[str], topics: CameraTopics | None = None, every_s: float = 0.0
) -> Iterator[RecordedFrame]:
    """Yield the frames of a bag in the order of the recording.

    `RecordedFrame.name` is the number of the depth picture; `notes` tell the topics and what became of the colour:
    "aligned" (of the same camera), "registered" (of another one, by tf) or "none"; and `recorded_s`, the recorder's
    time [s]. `frame.time_s` is that of the header. `frame.T_robot_camera` is that of tf, if it tells one.

    Args:
        path: ROS 1 bag, folder of a ROS 2 bag, or one mcap file.
        topics: Those of the camera, as far as they are to be chosen.
        every_s: Frames that follow the one before by less than this are left out [s].

    Raises:
        InputError: If it is no bag, damaged, holds no depth or no intrinsics, or where it is not clear which.
        MissingExtraError: If `rosbags` is not installed.
    """
    path = Path(path)
    if not path.exists():
        raise InputError(f"{path}: cannot be read (no such file or folder)")
    with open_bag(path) as bag:
        chosen = choose_topics(bag, topics or CameraTopics(), path)
        camera = _BagCamera(bag, chosen, path)
        last_s = -np.inf
        for number, depth, colour in _pairs(bag, chosen, path):
            if depth.recorded_s - last_s >= every_s - 1e-6:
                last_s = depth.recorded_s
                yield camera.frame(number, depth, colour)


def _pairs(bag: Bag, topics: CameraTopics, path: Path) -> Iterator[tuple[int, _Taken, _Taken | None]]:
    """Yield each depth picture with its number and the colour picture that is nearest in time, if one is near."""
    assert topics.depth is not None
    colours: deque[_Taken] = deque(maxlen=64)
    waiting: deque[tuple[int, _Taken]] = deque()
    number = 0
    for topic, taken in _messages(bag, topics, path):
        if topic == topics.depth:
            waiting.append((number, taken))
            number += 1
        else:
            colours.append(taken)
        while waiting and _is_ready(waiting[0][1], colours, taken.recorded_s, topics.colour is None):
            count, depth = waiting.popleft()
            yield count, depth, _nearest(depth, colours)
    for count, depth in waiting:
        yield count, depth, _nearest(depth, colours)


def _messages(bag: Bag, topics: CameraTopics, path: Path) -> Iterator[tuple[str, _Taken]]:
    """Yield depth and colour pictures with their topics."""
    wanted = [topic for topic in (topics.depth, topics.colour) if topic is not None]
    for topic, recorded_s, content in bag.with_topics(*wanted):
        with as_defined(f"{path}: {topic}"):
            stamp = stamp_s(content.header)
            yield topic, _Taken(stamp if stamp > 0.0 else recorded_s, recorded_s, content)


def _is_ready(depth: _Taken, colours: deque[_Taken], now_s: float, alone: bool) -> bool:
    return alone or now_s - depth.recorded_s > _WAIT_S or bool(colours and colours[-1].stamp_s >= depth.stamp_s)


def _nearest(depth: _Taken, colours: deque[_Taken]) -> _Taken | None:
    best = min(colours, key=lambda each: abs(each.stamp_s - depth.stamp_s), default=None)
    return best if best is not None and abs(best.stamp_s - depth.stamp_s) <= _NEAR_S else None


class _BagCamera:
    """Makes frames of messages.

    Args:
        bag: The bag, for what is in it once: intrinsics and the tree of frames.
        topics: Of the camera, all that there are.
        path: For errors.
    """

    def __init__(self, bag: Bag, topics: CameraTopics, path: Path) -> None:
        self._topics, self._path = topics, path
        self._tree = FrameTree(bag.messages(*bag.of_type(*TRANSFORMS)))
        infos = {topic: self._first(bag, topic) for topic in (topics.depth_info, topics.colour_info) if topic}
        self._info = infos[topics.depth_info or ""]
        self._colour_info = infos.get(topics.colour_info or "")
        self._cameras: dict[tuple[str, tuple[int, int]], Pinhole] = {}

    def _first(self, bag: Bag, topic: str) -> Any:
        return next(iter(bag.messages(topic))).content

    def frame(self, number: int, depth: _Taken, colour: _Taken | None) -> RecordedFrame:
        """Return the frame of a depth picture and the colour picture that goes with it."""
        topics, name = self._topics, f"{number:06d}"
        with self._told(topics.depth):
            values = depth_of(depth.content)
            camera = self._camera(topics.depth or "", self._info, values.shape)
            mount = self._mount(frame_name(depth.content.header.frame_id))
            frame = RgbdFrame(values, grey(camera), camera, depth.stamp_s, mount, camera_height=None)
        how = "none"
        if colour is not None:
            with self._told(topics.colour):
                frame, how = self._coloured(frame, depth.content, colour.content)
        notes = {"depth_topic": topics.depth, "colour_topic": topics.colour, "colour": how}
        return RecordedFrame(name, frame, {**notes, "recorded_s": depth.recorded_s})

    def _coloured(self, frame: RgbdFrame, depth: Any, colour: Any) -> tuple[RgbdFrame, str]:
        pixels = colour_of(colour)
        here, there = frame_name(depth.header.frame_id), frame_name(colour.header.frame_id)
        if here == there and pixels.shape[:2] == frame.depth.shape:
            return replace(frame, colour=pixels), "aligned"
        T_colour_depth = np.eye(4) if here == there else self._tree.between(there, here)
        info = self._colour_info or (self._info if here == there else None)
        if T_colour_depth is None or info is None:
            return frame, "none"
        camera = self._camera(self._topics.colour or "", info, pixels.shape)
        turn = turned_optical(np.eye(4))
        pose = np.asarray(np.linalg.inv(turn) @ T_colour_depth @ turn, dtype=np.float64)
        return replace(frame, colour=registered_colour(frame.depth, frame.camera, pixels, camera, pose)), "registered"

    def _camera(self, topic: str, info: Any, shape: tuple[int, ...]) -> Pinhole:
        """Return the camera of the pictures of a topic that have `shape` (h, w, ...)."""
        size = (int(shape[1]), int(shape[0]))
        if (topic, size) not in self._cameras:
            self._cameras[topic, size] = camera_of(info, size, "image_rect" in topic)
        return self._cameras[topic, size]

    def _mount(self, optical: str) -> tuple[float, float, float]:
        """Return T_robot_camera in the plane, by tf; the robot's origin if tf does not tell it."""
        for base in ("base_link", "base_footprint", "base"):
            matrix = self._tree.between(base, optical) if base != optical else None
            if matrix is not None:
                matrix = turned_optical(matrix)
                return float(matrix[0, 3]), float(matrix[1, 3]), float(np.arctan2(matrix[1, 0], matrix[0, 0]))
        return 0.0, 0.0, 0.0

    @contextmanager
    def _told(self, topic: str | None) -> Iterator[None]:
        """Tell the bag and the topic of what is wrong with a message."""
        where = f"{self._path}: {topic}"
        try:
            with as_defined(where):
                yield
        except InputError as error:
            raise error if str(error).startswith(where) else InputError(f"{where}: {error}") from error
