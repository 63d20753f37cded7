"""ROS bags: messages of any values, and damaged files of both kinds."""

import tempfile
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from fuzzer.border import Area, Border, Input
from fuzzer.files import put, put_all
from fuzzer.mutations import extreme_float, mutated_bytes, mutated_text
from fuzzer.sanity import sane_drive
from numpy.random import Generator
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_typestore
from tagalong.slam import read_log

_FRAMES = ("/laser", "laser", "", "x" * 5000, "odom", "base_link", "a\nb", "\x1b[2J")
_SCAN, _ODOMETRY = "sensor_msgs/msg/LaserScan", "nav_msgs/msg/Odometry"
_DEFAULT = {"angle_min": -0.5, "angle_increment": 0.1, "range_min": 0.05, "range_max": 8.0, "frame": "laser"}


@cache
def _store(ros2: bool) -> Any:
    return get_typestore(Stores.ROS2_HUMBLE if ros2 else Stores.ROS1_NOETIC)


def messages(rng: Generator) -> Input:
    """Return three scans and their odometry, of which some values are extreme."""
    scans = [{**_DEFAULT, "time": 0.1 * k, "ranges": [2.0] * 10, "pose": [0.1 * k, 0, 0, 1]} for k in range(3)]
    for _ in range(int(rng.integers(1, 4))):
        scan = scans[int(rng.integers(3))]
        key = list(scan)[int(rng.integers(len(scan)))]
        if key == "frame":
            scan[key] = _FRAMES[int(rng.integers(len(_FRAMES)))]
        elif key == "time":
            scan[key] = float(np.clip(np.nan_to_num(extreme_float(rng)), 0, 4e9))
        elif key in ("ranges", "pose"):
            scan[key] = [extreme_float(rng) if rng.random() < 0.3 else v for v in scan[key]]
            scan[key] = scan[key] if key == "pose" or rng.random() < 0.8 else []
        else:
            scan[key] = float(np.float32(np.clip(extreme_float(rng), -3e38, 3e38)))
    return {"scans": scans, "odometry": bool(rng.random() < 0.8)}


def write_bag(path: Path, value: Input, ros2: bool) -> Path:
    """Write a bag of scans and, if wanted, odometry."""
    store, kinds = _store(ros2), _store(ros2).types
    with Writer2(path, version=9) if ros2 else Writer1(path) as bag:
        links = {
            kind: bag.add_connection(topic, kind, typestore=store)
            for topic, kind in (("/scan", _SCAN), ("/odom", _ODOMETRY))
        }
        for scan in value["scans"]:
            for kind, message in _of(kinds, scan, ros2):
                if kind == _SCAN or value["odometry"]:
                    data = (store.serialize_cdr if ros2 else store.serialize_ros1)(message, kind)
                    bag.write(links[kind], round(1e9 * (1000.0 + scan["time"])), data)
    return path


def odometry_and_laser(scan: dict[str, Any]) -> list[Any]:
    """Return the two messages of ROS 2 of a scan as `messages` makes them, its time made one that a stamp holds."""
    time = float(np.clip(np.nan_to_num(scan["time"]), 0.0, 2.0**31 - 1.0))
    return [message for _, message in _of(_store(True).types, {**scan, "time": time - 1000.0}, ros2=True)]


def _of(kinds: Any, scan: dict[str, Any], ros2: bool) -> list[tuple[str, Any]]:
    """Return the two messages of a scan."""
    time = 1000.0 + scan["time"]
    stamp = kinds["builtin_interfaces/msg/Time"](sec=int(time) % 2**31, nanosec=int(1e9 * (time % 1.0)))
    count = {} if ros2 else {"seq": 0}

    def header(frame: str) -> Any:
        return kinds["std_msgs/msg/Header"](stamp=stamp, frame_id=frame, **count)

    fan = {"angle_min": scan["angle_min"], "angle_increment": scan["angle_increment"], "angle_max": 0.5}
    limits = {"range_min": scan["range_min"], "range_max": scan["range_max"], "scan_time": 0.1, "time_increment": 0.0}
    with np.errstate(all="ignore"):
        ranges = np.array(scan["ranges"], np.float32)
    laser = kinds[_SCAN](
        header=header(scan["frame"]), **fan, **limits, ranges=ranges, intensities=np.zeros(0, np.float32)
    )
    x, y, z, w = (float(v) for v in scan["pose"])
    nothing = kinds["geometry_msgs/msg/Vector3"](x=0.0, y=0.0, z=0.0)
    pose = kinds["geometry_msgs/msg/Pose"](
        position=kinds["geometry_msgs/msg/Point"](x=x, y=y, z=0.0),
        orientation=kinds["geometry_msgs/msg/Quaternion"](x=0.0, y=0.0, z=z, w=w),
    )
    odometry = kinds[_ODOMETRY](
        header=header("odom"), child_frame_id="base_link",
        pose=kinds["geometry_msgs/msg/PoseWithCovariance"](pose=pose, covariance=np.zeros(36)),
        twist=kinds["geometry_msgs/msg/TwistWithCovariance"](
            twist=kinds["geometry_msgs/msg/Twist"](linear=nothing, angular=nothing), covariance=np.zeros(36)
        ),
    )  # fmt: skip
    return [(_ODOMETRY, odometry), (_SCAN, laser)]


def _with_messages(value: Input, folder: Path) -> Any:
    (folder / "drive.bag").unlink(missing_ok=True)
    return read_log(write_bag(folder / "drive.bag", value, ros2=False))


@cache
def sound(ros2: bool) -> dict[str, bytes]:
    """Return the files of a sound bag by name."""
    scans = [{**_DEFAULT, "time": 0.1 * k, "ranges": [2.0] * 10, "pose": [0.1 * k, 0, 0, 1]} for k in range(2)]
    with tempfile.TemporaryDirectory() as folder:
        path = write_bag(Path(folder) / "drive.bag", {"scans": scans, "odometry": True}, ros2)
        files = sorted(path.iterdir()) if ros2 else [path]
        return {file.name: file.read_bytes() for file in files}


def damaged1(rng: Generator) -> Input:
    """Return a damaged ROS 1 bag."""
    return mutated_bytes(rng, sound(False)["drive.bag"])


def damaged2(rng: Generator) -> Input:
    """Return a ROS 2 bag as the edits of its two files: the YAML's text, and bytes of the other."""
    files = dict(sound(True))
    for name in files:
        if name.endswith(".yaml") and rng.random() < 0.6:
            files[name] = mutated_text(rng, files[name])
        elif not name.endswith(".yaml") and rng.random() < 0.6:
            files[name] = mutated_bytes(rng, files[name])
    return files


AREA = Area(
    (
        Border(name="bags.messages", make=messages, call=_with_messages, sane=sane_drive, file="drive.bag", ms=78.0),
        Border(
            name="bags.ros1", make=damaged1, sane=sane_drive, file="drive.bag", ms=6.0,
            reserved_mb=5000,  # of a record up to 4 GiB, as a bag states it; its bytes are not there
            call=lambda value, folder: read_log(put(folder, "drive.bag", value)),
        ),
        Border(
            name="bags.ros2", make=damaged2, sane=sane_drive, file="bag2", ms=12.0,
            call=lambda value, folder: read_log(put_all(folder / "bag2", value)),
        ),
    ),
    lambda: sound(True) and sound(False) and None,
)  # fmt: skip
