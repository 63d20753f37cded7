"""Bags of RGB-D cameras, written with the `rosbags` library as drivers write them."""

import io
import struct

import numpy as np
from PIL import Image
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_typestore

FOCAL, OPTICAL = 140.0, "camera_optical"


def rvl(depth):
    """Return what Wilson's published encoder makes of (h, w) uint16."""
    nibbles, values, at, before = [], depth.ravel().tolist(), 0, 0

    def put(value):
        while True:
            rest = value >> 3
            nibbles.append((value & 7) | (8 if rest else 0))
            value = rest
            if not value:
                return

    while at < len(values):
        start = at
        while at < len(values) and values[at] == 0:
            at += 1
        put(at - start)
        start = at
        while at < len(values) and values[at] != 0:
            at += 1
        put(at - start)
        for value in values[start:at]:
            step = value - before
            put((step << 1) ^ (step >> 63))
            before = value
    nibbles += [0] * (-len(nibbles) % 8)
    words = [sum(n << (28 - 4 * k) for k, n in enumerate(nibbles[i : i + 8])) for i in range(0, len(nibbles), 8)]
    return np.array(words, "<u4").tobytes()


def png(pixels):
    file = io.BytesIO()
    Image.fromarray(pixels).save(file, "PNG")
    return file.getvalue()


def compressed_depth(depth, how):
    """Return format and bytes of compressed_depth_image_transport: "png", "rvl", or "32FC1" of inverse depth."""
    if how == "rvl":
        height, width = depth.shape
        return "16UC1; compressedDepth rvl", struct.pack("<iffii", 0, 0.0, 0.0, width, height) + rvl(depth)
    if how == "png":
        return "16UC1; compressedDepth png", struct.pack("<iff", 0, 0.0, 0.0) + png(depth)
    scale = 100.0 * 101.0
    shift = 1.0 - scale / 10.0
    inverse = np.where(depth > 0, np.round(scale / np.maximum(1e-3 * depth, 1e-6) + shift), 0.0)
    return "32FC1; compressedDepth", struct.pack("<iff", 0, scale, shift) + png(inverse.astype(np.uint16))


class CameraBag:
    """A bag in the writing."""

    def __init__(self, path, *, ros1=True):
        self.ros1, self._store = ros1, get_typestore(Stores.ROS1_NOETIC if ros1 else Stores.ROS2_HUMBLE)
        self._writer = Writer1(path) if ros1 else Writer2(path, version=9, storage_plugin=StoragePlugin.MCAP)
        self._topics = {}

    def __enter__(self):
        self._writer.open()
        return self

    def __exit__(self, *_):
        self._writer.close()

    def make(self, kind, **fields):
        return self._store.types[kind](**fields)

    def header(self, time_s, frame):
        stamp = self.make("builtin_interfaces/msg/Time", sec=int(time_s), nanosec=round((time_s % 1.0) * 1e9))
        return self.make("std_msgs/msg/Header", **({"seq": 0} if self.ros1 else {}), stamp=stamp, frame_id=frame)

    def put(self, topic, kind, time_s, message):
        if topic not in self._topics:
            self._topics[topic] = self._writer.add_connection(topic, kind, typestore=self._store)
        write = self._store.serialize_ros1 if self.ros1 else self._store.serialize_cdr
        self._writer.write(self._topics[topic], round(time_s * 1e9), bytes(write(message, kind)))

    def image(self, topic, time_s, pixels, encoding, frame=OPTICAL, step=None):
        height, width = pixels.shape[:2]
        rows = np.ascontiguousarray(pixels).view(np.uint8).reshape(height, -1)
        rows = np.pad(rows, ((0, 0), (0, (step or rows.shape[1]) - rows.shape[1])))
        message = self.make(
            "sensor_msgs/msg/Image", header=self.header(time_s, frame), height=height, width=width, encoding=encoding,
            is_bigendian=0, step=rows.shape[1], data=rows.ravel(),
        )  # fmt: skip
        self.put(topic, "sensor_msgs/msg/Image", time_s, message)

    def compressed(self, topic, time_s, said, data, frame=OPTICAL):
        kind = "sensor_msgs/msg/CompressedImage"
        fields = {"header": self.header(time_s, frame), "format": said, "data": np.frombuffer(data, np.uint8)}
        self.put(topic, kind, time_s, self.make(kind, **fields))

    def info(self, topic, time_s, size, model="plumb_bob", distortion=(0.0,) * 5, frame=OPTICAL, focal=FOCAL):
        width, height = size
        k = np.array([focal, 0, (width - 1) / 2, 0, focal, (height - 1) / 2, 0, 0, 1.0])
        p = np.insert(k, (3, 6, 9), 0.0)
        names = ("D", "K", "R", "P") if self.ros1 else ("d", "k", "r", "p")
        matrices = zip(names, (np.array(distortion, float), k, np.eye(3).ravel(), p), strict=True)
        roi = self.make("sensor_msgs/msg/RegionOfInterest", x_offset=0, y_offset=0, height=0, width=0, do_rectify=False)
        message = self.make(
            "sensor_msgs/msg/CameraInfo", header=self.header(time_s, frame), height=height, width=width,
            distortion_model=model, binning_x=0, binning_y=0, roi=roi, **dict(matrices),
        )  # fmt: skip
        self.put(topic, "sensor_msgs/msg/CameraInfo", time_s, message)

    def transform(self, time_s, parent, child, move, turn=(0.0, 0.0, 0.0, 1.0)):
        v, q = dict(zip("xyz", move, strict=True)), dict(zip("xyzw", turn, strict=True))
        inner = self.make(
            "geometry_msgs/msg/Transform",
            translation=self.make("geometry_msgs/msg/Vector3", **v),
            rotation=self.make("geometry_msgs/msg/Quaternion", **q),
        )
        link = self.make(
            "geometry_msgs/msg/TransformStamped", header=self.header(time_s, parent), child_frame_id=child,
            transform=inner,
        )  # fmt: skip
        kind = "tf2_msgs/msg/TFMessage"
        self.put("/tf_static", kind, time_s, self.make(kind, transforms=[link]))
