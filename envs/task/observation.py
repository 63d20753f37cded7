"""The observation of a follow environment: its spaces, and its arrays from what the robot believes."""

from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from ...perception.rgbd.frame import RgbdFrame
from ...perception.tracking.people import People
from ...slam.scan import LaserScan
from ..follow_config import FollowConfig
from ..onboard.stack import Belief
from ..sensors.camera.config import RgbdConfig
from .interface import LEADER_COLUMNS, PERSON_COLUMNS
from .map_patch import MapPatch

Floats = NDArray[np.float32]

FARTHEST_M = 30.0
"""Positions of people are clipped to this [m]."""
FASTEST_MPS = 3.0
"""Velocities are clipped to this [m/s]."""
FASTEST_TURN = 6.0
"""The measured turn rate is clipped to this [rad/s]."""

_LOW = np.array([-FARTHEST_M, -FARTHEST_M, -FASTEST_MPS, -FASTEST_MPS, 0.0, 0.0], dtype=np.float32)
_HIGH = np.array([FARTHEST_M, FARTHEST_M, FASTEST_MPS, FASTEST_MPS, 1.0, 1.0], dtype=np.float32)


def observation_space(config: FollowConfig) -> spaces.Dict:
    """Return the observation space; `map` is there only where something builds a map, `leader` only with a leader."""
    slots = config.people_slots
    top = [FASTEST_MPS] * (2 if config.drive == "holonomic" else 1) + [FASTEST_TURN]
    fastest = np.array(top, dtype=np.float32)
    entries: dict[str, spaces.Space] = {
        "scan": spaces.Box(0.0, 1.0, (config.beams,), np.float32),
        "people": spaces.Box(np.tile(_LOW, (slots, 1)), np.tile(_HIGH, (slots, 1)), (slots, len(PERSON_COLUMNS))),
        "velocity": spaces.Box(-fastest, fastest, fastest.shape, np.float32),
    }
    if "rgbd" in config.sensors:
        width, height = config.camera_pixels
        entries["rgb"] = spaces.Box(0, 255, (height, width, 3), np.uint8)
        entries["depth"] = spaces.Box(0.0, 1.0, (height, width), np.float32)
    if config.leader:
        entries["leader"] = spaces.Box(_LOW, _HIGH, (len(LEADER_COLUMNS),), np.float32)
    if config.slam is not None:
        entries["map"] = spaces.Box(0.0, 1.0, (config.map_cells, config.map_cells), np.float32)
    return spaces.Dict(entries)


class Observer:
    """Turns beliefs into observations; every array is new in every step."""

    def __init__(self, config: FollowConfig) -> None:
        self._slots = config.people_slots
        self._leader = config.leader
        self._planar = config.drive == "holonomic"
        self._farthest = RgbdConfig().range_max
        self._patch = MapPatch(config.map_cells, config.map_resolution) if config.slam is not None else None

    def observe(self, belief: Belief, frames: tuple[RgbdFrame, ...] = ()) -> dict[str, NDArray[Any]]:
        """Return the observation of `belief` and of the last of the camera's `frames`, if there are any."""
        observation: dict[str, NDArray[Any]] = {
            "scan": scan_entry(belief.scan),
            "people": people_entry(belief.people_robot, belief.leader_id, self._slots),
            "velocity": self._velocity_entry(belief.velocity),
        }
        if self._leader:
            observation["leader"] = leader_entry(belief)
        if self._patch is not None:
            observation["map"] = self._patch.around(belief.map, belief.map_pose)
        if frames:
            observation["rgb"] = frames[-1].colour.copy()
            observation["depth"] = depth_entry(frames[-1], self._farthest)
        return observation

    def _velocity_entry(self, velocity: NDArray[np.float64]) -> Floats:
        forward, left, turn = velocity.tolist()
        linear = [forward, left] if self._planar else [forward]
        clipped = [min(max(v, -FASTEST_MPS), FASTEST_MPS) for v in linear]
        return np.array([*clipped, min(max(turn, -FASTEST_TURN), FASTEST_TURN)], dtype=np.float32)


def scan_entry(scan: LaserScan) -> Floats:
    """Return (N,) ranges over `range_max`; beams without a return or without a measurement read 1."""
    share = scan.ranges / scan.range_max
    return np.where(scan.is_return, share, 1.0).astype(np.float32)


def depth_entry(frame: RgbdFrame, farthest: float) -> Floats:
    """Return (height, width) depths over `farthest` [m]; 0 where nothing was measured."""
    return np.clip(np.nan_to_num(frame.depth) / farthest, 0.0, 1.0).astype(np.float32)


def leader_entry(belief: Belief) -> Floats:
    """Return (6,) the leader in the robot frame, columns `LEADER_COLUMNS`; zeros before there is one."""
    leader = belief.leader
    if leader is None:
        return np.zeros(len(LEADER_COLUMNS), dtype=np.float32)
    row = [*leader.position, *leader.velocity, leader.confidence, float(leader.visible)]
    return np.clip(np.array(row, dtype=np.float32), _LOW, _HIGH)


def people_entry(people: People, leader_id: int, slots: int) -> Floats:
    """Return (slots, 6) the people who do not lead, the nearest first, columns `PERSON_COLUMNS`."""
    table = np.zeros((slots, len(PERSON_COLUMNS)), dtype=np.float32)
    others = np.flatnonzero(people.ids != leader_id)
    if len(others) == 0:
        return table
    distance = np.hypot(people.positions[others, 0], people.positions[others, 1])
    nearest = others[np.argsort(distance, kind="stable")[:slots]]
    count = len(nearest)
    table[:count, 0:2] = people.positions[nearest]
    table[:count, 2:4] = people.velocities[nearest]
    table[:count, 4] = people.confidence[nearest]
    table[:count, 5] = 1.0
    return np.clip(table, _LOW, _HIGH)
