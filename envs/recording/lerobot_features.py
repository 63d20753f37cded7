"""Demonstrations in LeRobot's terms: which features there are, and their values, frame by frame.

LeRobot has no word for a laser scanner. The convention here is a feature of its own, what its numbers mean beside it:

    observation.lidar   (beams,) float32: range over `range_max`, 0 .. 1; 1 is no return or no measurement. Its `info`
                        in meta/info.json: `lidar.bearings_rad` (one a beam, counter-clockwise from straight ahead, in
                        the laser's frame), `lidar.range_max_m`, `lidar.T_robot_lidar` (x, y [m], theta [rad])

The rest has LeRobot's names: `observation.state` is the robot's own velocity; `observation.environment_state` the
leader and then the other people, in the robot's frame; any other entry keeps its name behind `observation.`.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..task.interface import LEADER_COLUMNS, PERSON_COLUMNS, FollowInterface
from .demonstration import Demonstration

Feature = dict[str, Any]
Frames = dict[str, NDArray[Any]]

_SPEEDS = ("forward", "turn")
_SPEEDS_HOLONOMIC = ("forward", "left", "turn")
_PEOPLE = ("leader", "people")
SUCCESSES = ("tour_done", "covered")


def frames_of(one: Demonstration) -> Frames:
    """Return (T, ...) what was observed before each action, the action, and what came of it; the end is left out."""
    before = {name: array[:-1] for name, array in one.observations.items()}
    known = [before.pop(name).reshape(len(one), -1) for name in _PEOPLE if name in before]
    frames: Frames = {"observation.state": before.pop("velocity")} if "velocity" in before else {}
    if known:
        frames["observation.environment_state"] = np.concatenate(known, axis=1)
    if "scan" in before:
        frames["observation.lidar"] = before.pop("scan")
    frames |= {f"observation.{name}": array for name, array in before.items()}
    done = one.terminated | one.truncated
    frames |= {"action": one.actions, "next.reward": one.rewards.astype(np.float32), "next.done": done}
    frames["next.success"] = done & (one.ending in SUCCESSES)
    return frames


def indexed(frames: Frames, episode: int, first: int, control_hz: float) -> Frames:
    """Return the frames with LeRobot's own columns: when and where in the dataset they are; all are of task 0."""
    number = np.arange(len(frames["action"]), dtype=np.int64)
    own = {
        "timestamp": (number / control_hz).astype(np.float32),
        "frame_index": number,
        "episode_index": np.full_like(number, episode),
        "index": number + first,
        "task_index": np.zeros_like(number),
    }
    return {**frames, **own}


def describe(one: Demonstration, frames: Frames, interface: FollowInterface) -> dict[str, Feature]:
    """Return LeRobot's description of each column: type, shape, names of the numbers where they have some."""
    speeds = _SPEEDS_HOLONOMIC if interface.holonomic else _SPEEDS
    names = {
        "observation.state": [f"{name}_velocity" for name in speeds],
        "observation.environment_state": _people_names(one),
        "action": [f"{name}_command" for name in speeds],
    }
    info = {"observation.lidar": _lidar(interface)}
    return {name: _feature(name, array, names, info) for name, array in frames.items()}


def _feature(
    name: str, array: NDArray[Any], names: Mapping[str, list[str]], info: Mapping[str, dict[str, Any]]
) -> Feature:
    shape = list(array.shape[1:]) or [1]
    told = {"info": info[name]} if name in info else {}
    return {"dtype": str(array.dtype), "shape": shape, "names": names.get(name), **told}


def _people_names(one: Demonstration) -> list[str]:
    leader = [f"leader_{column}" for column in LEADER_COLUMNS] if "leader" in one.observations else []
    slots = one.observations["people"].shape[1] if "people" in one.observations else 0
    return leader + [f"person_{slot}_{column}" for slot in range(slots) for column in PERSON_COLUMNS]


def _lidar(interface: FollowInterface) -> dict[str, Any]:
    return {
        "lidar.bearings_rad": interface.bearings.tolist(),
        "lidar.range_max_m": interface.range_max,
        "lidar.T_robot_lidar": list(interface.T_robot_lidar),
    }
