"""The observation of a follow environment: its spaces, and its arrays from what the robot believes."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import ArrayLike, NDArray

from ...perception.rgbd.frame import RgbdFrame
from ...perception.tracking.people import People
from ...slam.bounds import Cell, check_numbers
from ...slam.errors import InputError, shown
from ...slam.scan import LaserScan
from ..limits.field_checks import MapCells, Slots
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


Entry = tuple[spaces.Space[Any], Callable[[Belief], ArrayLike]]
"""The space of an entry of the observation, and what it holds: a function of what the robot believes."""
OWN_ENTRIES = ("scan", "people", "velocity", "leader", "map", "rgb", "depth")


@dataclass(frozen=True, kw_only=True)
class ObservationConfig:
    """What is observed.

    Attributes:
        people_slots: Most people in entry `people`; the nearest are kept.
        map_cells: Side of entry `map` [cells].
        map_resolution: Side of a cell of it [m].
        entries: Further entries: name -> (space, function). The function is given the `Belief` of the onboard stack,
            never the truth, and returns an array of the space's shape; `info` and the reward may know the truth.
    """

    people_slots: Slots = 6
    map_cells: MapCells = 64
    map_resolution: Cell = 0.1
    entries: Mapping[str, Entry] = field(default_factory=dict)

    def __post_init__(self) -> None:
        check_numbers(self)
        if not isinstance(self.entries, Mapping):
            rule = "a table of names, each with a space and a function"
            raise InputError(f"`observation.entries` must be {rule}, got {shown(self.entries)}")
        for name, entry in self.entries.items():
            if not isinstance(name, str) or name in OWN_ENTRIES:
                raise InputError(f"an entry of `observation.entries` needs a name of its own, got {shown(name)}")
            good = isinstance(entry, tuple | list) and len(entry) == 2 and callable(entry[1])
            if not good or not isinstance(entry[0], spaces.Box | spaces.Discrete | spaces.MultiBinary):
                rule = "(space, function): a Box, Discrete or MultiBinary, and what returns a value of it"
                raise InputError(f"`observation.entries[{name!r}]` must be {rule}, got {shown(entry)}")


@dataclass(frozen=True, kw_only=True)
class Observed:
    """What there is to observe.

    Attributes:
        config: What is observed.
        beams: Beams of the laser.
        holonomic: Whether the robot drives sideways, too.
        leader: Whether somebody leads.
        map: Whether somebody maps.
        camera: The camera; None for none.
    """

    config: ObservationConfig
    beams: int
    holonomic: bool
    leader: bool
    map: bool
    camera: RgbdConfig | None


def observation_space(observed: Observed) -> spaces.Dict:
    """Return the observation space; `map` is there only where something builds a map, `leader` only with a leader."""
    slots, cells = observed.config.people_slots, observed.config.map_cells
    top = [FASTEST_MPS] * (2 if observed.holonomic else 1) + [FASTEST_TURN]
    fastest = np.array(top, dtype=np.float32)
    entries: dict[str, spaces.Space] = {
        "scan": spaces.Box(0.0, 1.0, (observed.beams,), np.float32),
        "people": spaces.Box(np.tile(_LOW, (slots, 1)), np.tile(_HIGH, (slots, 1)), (slots, len(PERSON_COLUMNS))),
        "velocity": spaces.Box(-fastest, fastest, fastest.shape, np.float32),
    }
    if observed.camera is not None:
        width, height = observed.camera.width, observed.camera.height
        entries["rgb"] = spaces.Box(0, 255, (height, width, 3), np.uint8)
        entries["depth"] = spaces.Box(0.0, 1.0, (height, width), np.float32)
    if observed.leader:
        entries["leader"] = spaces.Box(_LOW, _HIGH, (len(LEADER_COLUMNS),), np.float32)
    if observed.map:
        entries["map"] = spaces.Box(0.0, 1.0, (cells, cells), np.float32)
    return spaces.Dict({**entries, **{name: space for name, (space, _) in observed.config.entries.items()}})


class Observer:
    """Turns beliefs into observations; every array is new in every step."""

    def __init__(self, observed: Observed) -> None:
        config = observed.config
        self._slots = config.people_slots
        self._leader = observed.leader
        self._planar = observed.holonomic
        self._farthest = 0.0 if observed.camera is None else observed.camera.range_max
        self._patch = MapPatch(config.map_cells, config.map_resolution) if observed.map else None
        self._entries = config.entries

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
        for name, (space, function) in self._entries.items():
            observation[name] = own_entry(name, space, function(belief))
        return observation

    def _velocity_entry(self, velocity: NDArray[np.float64]) -> Floats:
        forward, left, turn = velocity.tolist()
        linear = [forward, left] if self._planar else [forward]
        clipped = [min(max(v, -FASTEST_MPS), FASTEST_MPS) for v in linear]
        return np.array([*clipped, min(max(turn, -FASTEST_TURN), FASTEST_TURN)], dtype=np.float32)


def own_entry(name: str, space: spaces.Space[Any], value: ArrayLike) -> NDArray[Any]:
    """Return a new array of the space's type and shape.

    Raises:
        InputError: If `value` has another shape, or holds what is no number of the type.
    """
    try:
        array = np.array(value, dtype=space.dtype)
    except (TypeError, ValueError, OverflowError):
        array = None
    if array is None or array.shape != space.shape:
        raise InputError(f"`observation.entries[{name!r}]` must return shape {space.shape}, got {shown(value)}")
    return array


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
