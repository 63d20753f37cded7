"""Nodes of ROS 2 without ROS: messages of any numbers, in any order, at any time, and parameters of any values."""

from dataclasses import fields
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from borders.bags import odometry_and_laser
from fuzzer.border import Area, Border, Call, Input, require
from fuzzer.grammars import poses, ranges
from fuzzer.mutations import extreme_float
from fuzzer.sanity import finite, sane_poses
from fuzzer.values import hostile_value
from numpy.random import Generator
from rosbags.typesys import Stores, get_typestore
from tagalong.scripts.ros.node import NODES
from tagalong.scripts.ros.outputs import FRAMES, ODOMETRY, SCAN
from tagalong.slam import InputError

_BEAMS = 90
_LIKELY: dict[str, Any] = {"laser_pose": (0.1, 0.0, 0.0), "forest": "simulation", "preset": "recorded"}
_EXTREME = ("time", "ranges", "pose", "angle_min", "angle_increment", "range_min", "range_max", "now")


def _stream(rng: Generator) -> list[dict[str, Any]]:
    """Return 3 to 12 messages: a drive in a room, odometry that stands still for a while, jumps and comes back."""
    count = int(rng.integers(3, 13))
    walls, way = ranges(rng, _BEAMS), 0.3 * poses(rng, count)
    frozen = int(rng.integers(0, count))
    way[frozen : frozen + int(rng.integers(0, 6))] = way[frozen]
    if rng.random() < 0.3:
        way[int(rng.integers(count))] += rng.normal(0.0, 2.0, 3)
    return [
        {
            "time": 1000.0 + 0.1 * k, "now": 1000.05 + 0.1 * k,
            "ranges": np.round(walls + rng.normal(0.0, 0.01, _BEAMS), 3).tolist(),
            "angle_min": -0.05 * _BEAMS / 2, "angle_increment": 0.05, "range_min": 0.05, "range_max": 10.0,
            "frame": "laser", "pose": [float(x), float(y), float(np.sin(turn / 2)), float(np.cos(turn / 2))],
            "order": [ODOMETRY, SCAN] if rng.random() < 0.9 else [SCAN, ODOMETRY, FRAMES, SCAN],
        }
        for k, (x, y, turn) in enumerate(way)
    ]  # fmt: skip


def _hostile(rng: Generator) -> list[dict[str, Any]]:
    """Return such messages, of which up to four values are extreme."""
    frames = _stream(rng)
    for _ in range(int(rng.integers(0, 5))):
        frame = frames[int(rng.integers(len(frames)))]
        key = _EXTREME[int(rng.integers(len(_EXTREME)))]
        if key in ("ranges", "pose"):
            frame[key] = [extreme_float(rng) if rng.random() < 0.3 else v for v in frame[key]]
            if key == "ranges" and rng.random() < 0.3:
                frame[key] = frame[key][: int(rng.integers(len(frame[key])))]
        else:
            frame[key] = extreme_float(rng)
        frame["now"] = float(np.clip(np.nan_to_num(frame["now"]), 0.0, 9.2e9))  # of a clock that counts nanoseconds
    return frames


def _parameters(name: str, rng: Generator) -> list[Any]:
    """Return up to two parameters of a node as pairs of name and value."""
    known = fields(NODES[name][1])
    chosen = [known[int(k)] for k in rng.integers(0, len(known), int(rng.integers(0, 3)))]
    return [[field.name, hostile_value(rng, field.default)] for field in chosen]


def _made(name: str) -> Any:
    def make(rng: Generator) -> Input:
        return {"frames": _hostile(rng), "parameters": _parameters(name, rng) if rng.random() < 0.3 else []}

    return make


class _Maker:
    """Makes messages of ROS 2, as `RclpyMessages` does on a robot."""

    def __init__(self) -> None:
        self._store = get_typestore(Stores.ROS2_HUMBLE)

    def make(self, kind: str, **content: Any) -> Any:
        """Return a message of a type such as "std_msgs/msg/Float64"."""
        return self._store.types[kind](**content)


_maker = cache(_Maker)


def _node(name: str) -> Call:
    """Return what plays an input to a node, which has to take what comes after a message that it refused."""

    def call(value: Input, folder: Path) -> Any:
        logic_of, config_of = NODES[name]
        given = {key: tuple(x) if isinstance(x, list) else x for key, x in value["parameters"]}
        logic = logic_of(_maker(), config_of(**{**_LIKELY, **given}))
        sent, refused = [], None
        for frame in value["frames"]:
            told = dict(zip((ODOMETRY, SCAN), odometry_and_laser(frame), strict=True))
            for source in frame["order"]:
                try:
                    sent += logic.take(source, told.get(source, told[SCAN]), frame["now"])
                except InputError as error:
                    refused = error
            sent += logic.tick(frame["now"])
        if refused is not None and not sent:
            raise refused
        return logic.outputs, sent

    return call


def _sane_sent(result: Any) -> None:
    """Require topics that were announced, commands and transforms of finite numbers."""
    outputs, sent = result
    for topic, message in sent:
        require(topic in outputs, f"topic {topic}")
        require(message.__msgtype__ == outputs[topic], f"{message.__msgtype__} on {topic}")
        if topic == "cmd_vel":
            twist = getattr(message, "twist", message)
            finite([twist.linear.x, twist.linear.y, twist.angular.z], "a command", 1e3)
        elif topic == "/tf":
            for stamped in message.transforms:
                place = stamped.transform.translation
                sane_poses([place.x, place.y, place.z], "a transform")


def _warm() -> None:
    for name in NODES:
        rng = np.random.default_rng(3)
        _sane_sent(_node(name)({"frames": _stream(rng) + _stream(rng), "parameters": []}, Path()))


AREA = Area(
    tuple(
        Border(name=f"nodes.{name}", make=_made(name), call=_node(name), sane=_sane_sent, ms=ms)
        for name, ms in (("filter", 20.0), ("people", 20.0), ("follower", 30.0), ("slam", 60.0))
    ),
    _warm,
)
