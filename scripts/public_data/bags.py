"""The scans of a packed ROS 1 bag as arrays, every number as the bag has it."""

import lzma
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from ...slam.errors import InputError
from ...slam.files.input import named
from ...slam.logs.bag_messages import open_bag

_MOST_BYTES = 1 << 28


def npz_of_bag(source: Path) -> dict[str, Any]:
    """Return the arrays of a bag's one topic of scans.

    Args:
        source: The bag, .bag.xz.

    Raises:
        InputError: If it is damaged, or has not one such topic.
        MissingExtraError: If `rosbags` is not installed.
    """
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scans.bag"
        path.write_bytes(_unpacked(source))
        with open_bag(path) as bag:
            topic = bag.choose(None, ("sensor_msgs/msg/LaserScan",), "no option")
            if topic is None:
                raise InputError(f"{named(source)}: has no scans")
            rows = list(bag.messages(topic))
    first = rows[0].content
    numbers = ("angle_min", "angle_increment", "range_min", "range_max", "scan_time", "time_increment")
    return {
        "ranges": np.array([row.content.ranges for row in rows], dtype=np.float32),
        "stamp": np.array([_stamp(row.content.header.stamp) for row in rows]),
        "bag_time": np.array([row.recorded_s for row in rows]),
        **{name: np.float64(getattr(first, name)) for name in numbers},
        "frame": np.array(first.header.frame_id),
    }


def _stamp(stamp: Any) -> float:
    return stamp.sec + 1e-9 * stamp.nanosec


def _unpacked(source: Path) -> bytes:
    try:
        with lzma.open(source) as file:
            content = file.read(_MOST_BYTES + 1)
    except (lzma.LZMAError, EOFError, OSError) as error:
        raise InputError(f"{named(source)}: cannot be unpacked ({error})") from error
    if len(content) > _MOST_BYTES:
        raise InputError(f"{named(source)}: unpacks to more than {_MOST_BYTES} bytes")
    return content
