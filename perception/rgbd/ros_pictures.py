"""Pictures and intrinsics in messages of ROS: `sensor_msgs` Image, CompressedImage and CameraInfo, of ROS 1 and 2."""

import io
import struct
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...slam.errors import InputError, shown
from ...slam.files.pictures import decoded
from .frame import Pinhole
from .pictures import DEPTH_MODES
from .rvl import decode_rvl

IMAGE, COMPRESSED, CAMERA_INFO = (
    "sensor_msgs/msg/Image",
    "sensor_msgs/msg/CompressedImage",
    "sensor_msgs/msg/CameraInfo",
)
DEPTHS = {"16UC1": "u2", "mono16": "u2", "32FC1": "f4"}
"""Encodings of depth: whole numbers are millimetres, floats metres (REP 118)."""
COLOURS = {
    "rgb8": (3, (0, 1, 2)),
    "bgr8": (3, (2, 1, 0)),
    "8UC3": (3, (2, 1, 0)),
    "rgba8": (4, (0, 1, 2)),
    "bgra8": (4, (2, 1, 0)),
    "8UC4": (4, (2, 1, 0)),
    "mono8": (1, (0, 0, 0)),
    "8UC1": (1, (0, 0, 0)),
}
"""Encodings of colour: how many numbers a pixel has, and which of them are red, green and blue."""
MOST_SIDE = 8192
_MOST_BYTES = 64 << 20
_HEADER = struct.Struct("<iff")  # of compressed_depth_image_transport: how, and two parameters of it
_STRAIGHT = ("", "none")
_BROWN = ("plumb_bob", "rational_polynomial")
_INVERSE = ("inverse_brown_conrady", "modified_brown_conrady", "brown_conrady")


def is_depth(content: Any) -> bool:
    """Return whether an Image or CompressedImage holds depths."""
    if hasattr(content, "encoding"):
        return content.encoding in DEPTHS
    return "compressedDepth" in content.format


def depth_of(content: Any) -> NDArray[Any]:
    """Return (h, w) depths of an Image or CompressedImage: uint16 [mm], or float32 [m].

    Raises:
        InputError: If it holds none, or is damaged.
    """
    if not is_depth(content):
        raise InputError(f"a message of depths holds {shown(getattr(content, 'encoding', None) or content.format)}")
    if hasattr(content, "encoding"):
        return _pixels(content, DEPTHS[content.encoding], 1)[..., 0]
    return _compressed_depth(bytes(content.data), content.format)


def colour_of(content: Any) -> NDArray[np.uint8]:
    """Return (h, w, 3) red, green and blue of an Image or CompressedImage.

    Raises:
        InputError: If its encoding is not known, or it is damaged.
    """
    if not hasattr(content, "encoding"):
        return np.asarray(decoded(_file(bytes(content.data))).convert("RGB"))
    if content.encoding not in COLOURS:
        known = ", ".join(COLOURS)
        raise InputError(f"pictures of encoding {shown(content.encoding)} are not known; known are: {known}")
    channels, order = COLOURS[content.encoding]
    return np.ascontiguousarray(_pixels(content, "u1", channels)[..., order])


def camera_of(content: Any, size: tuple[int, int], rectified: bool) -> Pinhole:
    """Return the camera that a CameraInfo describes.

    Args:
        content: The message.
        size: Columns and rows of the pictures; if they are fewer, by one factor, than those that were calibrated, the
            intrinsics shrink with them.
        rectified: Whether the pictures have no distortion: then the matrix P holds, else K and D.

    Raises:
        InputError: If it holds no intrinsics, those of pictures of another shape, or a model of distortion that is
            not known.
    """
    rows = np.asarray(content.P if hasattr(content, "P") else content.p, dtype=np.float64).reshape(3, 4)
    if not (rectified and rows[0, 0] > 0.0):
        rows = np.asarray(content.K if hasattr(content, "K") else content.k, dtype=np.float64).reshape(3, 3)
    across = size[0] / content.width if content.width else 1.0
    down = size[1] / content.height if content.height else 1.0
    if abs(across / down - 1.0) > 0.02:
        raise InputError(
            f"camera_info is of {content.width} x {content.height} pixels, the pictures are of {size[0]} x {size[1]}"
        )
    focal = float(rows[0, 0]) * across, float(rows[1, 1]) * down
    centre = (float(rows[0, 2]) + 0.5) * across - 0.5, (float(rows[1, 2]) + 0.5) * down - 0.5
    return Pinhole.from_intrinsics(size, focal, centre, () if rectified else _distortion(content))


def _distortion(content: Any) -> tuple[float, ...]:
    """Return the coefficients of a CameraInfo, in the order of `Pinhole`.

    Those of RealSense's own models are left out: the models run the other way round, and bend by a pixel or so.
    """
    model = content.distortion_model
    numbers = tuple(map(float, content.D if hasattr(content, "D") else content.d))
    if model in (*_STRAIGHT, *_INVERSE) or not any(numbers):
        return ()
    if model not in _BROWN:
        raise InputError(f"distortion by the model {shown(model)} is not known; known are: {', '.join(_BROWN)}")
    return numbers[: 5 if model == "plumb_bob" else 8]


def _pixels(content: Any, kind: str, channels: int) -> NDArray[Any]:
    """Return (h, w, channels) numbers of an Image, whose rows may be padded."""
    order = ">" if content.is_bigendian else "<"
    dtype = np.dtype(kind).newbyteorder(order)
    height, width, step = int(content.height), int(content.width), int(content.step)
    if not (0 < height <= MOST_SIDE and 0 < width <= MOST_SIDE):
        raise InputError(f"a picture must have 1 to {MOST_SIDE} rows and columns, got {height} and {width}")
    least = width * channels * dtype.itemsize
    data = np.asarray(content.data, dtype=np.uint8).reshape(-1)
    if step < least or len(data) < (height - 1) * step + least:
        raise InputError(
            f"a picture of {width} x {height} pixels of {content.encoding} has rows of {least} bytes or more, got "
            f"rows of {step} and {len(data)} bytes in all"
        )
    rows = np.lib.stride_tricks.as_strided(data, (height, least), (step, 1), writeable=False)
    values = np.ascontiguousarray(rows).view(dtype).reshape(height, width, channels)
    return values.astype(dtype.newbyteorder("="), copy=False)


def _compressed_depth(data: bytes, said: str) -> NDArray[Any]:
    """Return the depths of a message of compressed_depth_image_transport, by PNG or RVL."""
    if len(data) < _HEADER.size + 8:
        raise InputError(f"a compressed depth picture has a header of {_HEADER.size} bytes, got {len(data)} in all")
    _, scale, shift = _HEADER.unpack_from(data)
    body = data[_HEADER.size :]
    if "rvl" in said.lower():
        columns, rows = struct.unpack_from("<ii", body)
        if not (0 < columns <= MOST_SIDE and 0 < rows <= MOST_SIDE):
            raise InputError(f"a picture must have 1 to {MOST_SIDE} rows and columns, got {rows} and {columns}")
        values = decode_rvl(body[8:], columns * rows).reshape(rows, columns)
    else:
        picture = decoded(_file(body))
        if picture.mode not in DEPTH_MODES:
            raise InputError(f"a depth picture has one channel of 16 bit, got mode {picture.mode}")
        values = np.asarray(picture).astype(np.uint16)
    if said.split(";")[0].strip() != "32FC1":
        return values
    # floats are kept as whole numbers of inverse depth: value = scale / depth + shift
    inverse = values.astype(np.float32) - np.float32(shift)
    good = (values > 0) & (inverse > 0.0)
    return np.where(good, np.float32(scale) / np.where(good, inverse, np.float32(1.0)), np.float32(np.nan))


def _file(data: bytes) -> io.BytesIO:
    if len(data) > _MOST_BYTES:
        raise InputError(f"a compressed picture has at most {_MOST_BYTES} bytes, got {len(data)}")
    return io.BytesIO(data)
