"""What the network is told: an observation, and what is remembered of those before, as numbers of order one."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...envs.task.interface import FollowInterface
from ...slam.errors import InputError
from ..protocol.follower import Observation
from ..scripted.leader_memory import Goal, LeaderMemory, MemoryConfig, Mode
from ..scripted.scan_points import own_velocity
from .known_beams import KnownBeams
from .steering import State
from .trail import Trail

Floats = NDArray[np.float32]

WAYS_M = (0.4, 0.8, 1.2, 1.8, 2.4, 3.2)
"""Points of the leader's trail that the network is told, by their way from the robot [m]."""


@dataclass(frozen=True, kw_only=True)
class FeatureConfig:
    """What is told, and how far.

    Attributes:
        sectors: Parts of equal width of the laser's field of view; of each, the nearest return.
        scan_range: Returns farther than this read as this [m].
        scan_decay: Distance over which the second reading of a sector, exp(-range / this), falls [m].
        people: Nearest bystanders that are told.
        people_range: Bystanders farther than this are left out [m].
        map_cells: Side of the map patch that is told, 0 for none [cells].
        field_of_view: Of the laser, half of it to either side of straight ahead [rad]; another laser is told as
            `KnownBeams` says.
    """

    sectors: int = 90
    scan_range: float = 6.0
    scan_decay: float = 0.6
    people: int = 4
    people_range: float = 5.0
    map_cells: int = 0
    field_of_view: float = float(np.radians(270.0))

    def __post_init__(self) -> None:
        if self.sectors < 8 or self.people < 1 or self.map_cells < 0:
            raise InputError(
                "features need at least 8 `sectors`, one of `people` and no negative `map_cells`, got "
                f"{self.sectors}, {self.people}, {self.map_cells}"
            )
        if not min(self.scan_range, self.scan_decay, self.people_range) > 0.0:
            raise InputError(
                "features need `scan_range`, `scan_decay` and `people_range` > 0 [m], got "
                f"{self.scan_range}, {self.scan_decay}, {self.people_range}"
            )
        if not 0.0 < self.field_of_view <= 2.0 * math.pi:
            raise InputError(f"`field_of_view` must be in (0, 2 pi] [rad], got {self.field_of_view}")

    @property
    def shapes(self) -> dict[str, tuple[int, ...]]:
        """Name -> shape of each input of the network."""
        shapes: dict[str, tuple[int, ...]] = {"scan": (2, self.sectors), "vector": (len(self.vector_names),)}
        if self.map_cells:
            shapes["map"] = (1, self.map_cells, self.map_cells)
        return shapes

    @property
    def vector_names(self) -> tuple[str, ...]:
        """Names of the entries of input `vector`, in their order."""
        leader = ("x", "y", "vx", "vy", "distance", "cos", "sin", "confidence", "seen", "known", "unseen")
        trail = [f"trail {way} m {axis}" for way in WAYS_M for axis in "xy"]
        people = [f"person {i} {what}" for i in range(self.people) for what in ("x", "y", "vx", "vy", "near", "there")]
        own = ("forward", "turn", "commanded speed", "acceleration", "commanded turn", "turn acceleration")
        return (*(f"leader {name}" for name in leader), *trail, *people, *own)


class Features:
    """Turns the observations of one episode into inputs of the network.

    Args:
        config: What is told.
        interface: Scales of the environment.

    Raises:
        InputError: If the laser does not look ahead.
    """

    def __init__(self, config: FeatureConfig, interface: FollowInterface) -> None:
        self.config = config
        self._laser = KnownBeams(interface, config.field_of_view, config.sectors)
        self._step_s = 1.0 / interface.control_hz
        self._range_max = interface.range_max
        beams = len(self._laser.interface.bearings)
        self._starts = np.round(np.arange(config.sectors) * beams / config.sectors).astype(np.intp)
        self._ways = np.array(WAYS_M)
        self.reset()

    def reset(self) -> None:
        """Forget everything."""
        self._memory = LeaderMemory(MemoryConfig(predicted=True), self._step_s)
        self._trail = Trail()
        self._unseen_s = 0.0

    @property
    def goal(self) -> Goal:
        """Where the leader is taken to be."""
        return self._memory.goal

    @property
    def search_turn(self) -> float:
        """Turn rate at which a lost leader is looked for now [rad/s]."""
        return self._memory.search_turn

    @property
    def trail(self) -> NDArray[np.float64]:
        """(k, 2) the leader's trail from here on, robot frame [m]; not to be written to."""
        return self._trail.points

    def update(self, observation: Observation, commanded: State) -> dict[str, Floats]:
        """Return the inputs for an observation; call it once a step.

        Args:
            observation: As of `FollowEnv`.
            commanded: What the steering commands now.
        """
        velocity = own_velocity(observation)
        leader = [float(value) for value in observation["leader"]]
        goal = self._memory.update(leader, velocity)
        seen = leader[5] > 0.5
        self._unseen_s = 0.0 if seen else self._unseen_s + self._step_s
        self._trail.update(velocity, self._step_s, (goal.x, goal.y) if seen else None)
        known = goal.mode is not Mode.WAIT
        away = max(goal.distance, 1e-3)
        told = [goal.x / 3.0, goal.y / 3.0, goal.vx, goal.vy, away - 1.3, goal.x / away, goal.y / away, leader[4]]
        told = [
            *(min(max(value, -3.0), 3.0) for value in told),
            float(seen),
            float(known),
            min(self._unseen_s, 8.0) / 4.0,
        ]
        trail = np.clip(self._trail.ahead(self._ways) / 2.0, -3.0, 3.0).ravel()
        own = (velocity[0], velocity[2], *commanded)
        vector = np.concatenate((told, trail, self._people(observation["people"]), own)).astype(np.float32)
        inputs = {"scan": self._scan(self._laser.scan(observation)), "vector": vector}
        if self.config.map_cells:
            inputs["map"] = self._map(observation)
        return inputs

    def _scan(self, scan: Floats) -> Floats:
        c = self.config
        nearest = np.minimum(np.minimum.reduceat(scan, self._starts) * np.float32(self._range_max), c.scan_range)
        return np.stack((nearest / c.scan_range, np.exp(-nearest / c.scan_decay))).astype(np.float32)

    def _people(self, rows: Floats) -> NDArray[np.float64]:
        told = np.zeros((self.config.people, 6))
        for told_row, row in zip(told, rows.tolist(), strict=False):
            x, y, vx, vy, _, there = row
            away = math.hypot(x, y)
            if there > 0.5 and away < self.config.people_range:
                told_row[:] = x / 2.0, y / 2.0, vx, vy, math.exp(-away), 1.0
        return told.ravel()

    def _map(self, observation: Observation) -> Floats:
        if "map" not in observation:
            raise InputError('this policy is told the map around the robot: the environment needs `slam="gmapping"`')
        patch, cells = observation["map"], self.config.map_cells
        edge = (patch.shape[0] - cells) // 2
        if edge < 0:
            raise InputError(f"this policy is told {cells} cells of the map, got an observation of {patch.shape[0]}")
        return patch[None, edge : edge + cells, edge : edge + cells].copy()
