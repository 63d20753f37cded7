"""Short drives from random places of a mapped building: what a robot sees that was carried there."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ...envs.physics.mj import mujoco
from ...envs.world.world import World, WorldConfig
from ...slam.geometry import between, compose, inverse, transform_points
from ...slam.logs.drive import RecordedDrive
from ...slam.occupancy_map import OccupancyMap
from ...slam.scan import LaserScan

Array = NDArray[np.float64]

_CLEARANCE = 0.45  # [m] of a random place to the nearest object: the robot fits, and can turn
_SPEED, _TURN = 0.5, 0.8  # [m/s, rad/s] of a simulated robot
_ROOM_AHEAD = 0.7  # [m] it turns where it has less


@dataclass(frozen=True, eq=False)
class Leg:
    """A short drive.

    Attributes:
        odometry: (n, 3) T_odom_robot.
        scans: The n scans.
        truth: (n, 3) T_map_robot.
    """

    odometry: Array
    scans: list[LaserScan]
    truth: Array

    def after(self, earlier: "Leg") -> "Leg":
        """Return this leg as the wheels of a robot tell it that was carried here from the end of `earlier`."""
        shift = compose(earlier.odometry[-1], inverse(self.odometry[0]))
        return Leg(compose(shift, self.odometry), self.scans, self.truth)


class LegSource(Protocol):
    """Draws legs."""

    def draw(self, count: int, rng: np.random.Generator) -> Leg:
        """Return a leg of `count` scans from a random place."""
        ...


class SimulatedLegs:
    """Legs in a simulated scene: a random free pose of the map, then ahead at 0.5 m/s, turning before objects.

    Args:
        scene: Name of the scene.
        seed: Seed of the building: that of the mapping drive.
        people: Number of people who walk in it.
        grid: The map.
        T_world_map: (3,) where the map lies in the world.
    """

    def __init__(self, scene: str, seed: int, people: int, grid: OccupancyMap, T_world_map: Array) -> None:
        config = WorldConfig(scene=scene, people=people, leader=False)
        self._world = World(config, np.random.default_rng(seed))
        self._free = transform_points(T_world_map, grid.cell_centres(grid.free))
        self._T_map_world = inverse(T_world_map)

    def draw(self, count: int, rng: np.random.Generator) -> Leg:
        """Return a leg of `count` scans, 0.1 s apart."""
        world = self._world
        self._carry(rng)
        odometry, scans, truth = [], [], []
        turning = False
        for _ in range(count):
            odometry.append(world.odometry)
            scans.append(world.scan())
            truth.append(compose(self._T_map_world, world.truth.robot_pose))
            ahead = scans[-1].ranges[(np.abs(scans[-1].bearings) < 0.5) & scans[-1].is_return]
            turning = bool(ahead.min(initial=np.inf) < _ROOM_AHEAD * (1.3 if turning else 1.0))
            world.step((0.0, _TURN) if turning else (_SPEED, 0.0))
        return Leg(np.array(odometry), scans, np.array(truth))

    def _carry(self, rng: np.random.Generator) -> None:
        world = self._world
        while True:
            place = self._free[rng.integers(len(self._free))]
            if world.scene.clearance(place) > _CLEARANCE:
                break
        world.data.qpos[:3] = (*place, rng.uniform(-np.pi, np.pi))
        world.data.qvel[:3] = 0.0
        mujoco.mj_forward(world.model, world.data)
        world.step((0.0, 0.0))


class RecordedLegs:
    """Legs of a log, of scans that the map was not made from, between which the robot moved.

    Args:
        drive: The log.
        truth: (n, 3) T_map_robot of its scans.
        unseen: (n,) which scans may be used.
        least_step: The robot moved at least so far between two scans, or turned by as many radians [m, rad].
    """

    def __init__(self, drive: RecordedDrive, truth: Array, unseen: NDArray[np.bool_], least_step: float = 0.1) -> None:
        self._drive, self._truth, self._kept = drive, truth, []
        for k in np.flatnonzero(unseen).tolist():
            moved = between(drive.odometry[self._kept[-1]], drive.odometry[k]) if self._kept else np.full(3, np.inf)
            if np.abs(moved).max() >= least_step:
                self._kept.append(k)

    def draw(self, count: int, rng: np.random.Generator) -> Leg:
        """Return a leg of `count` scans in the order of the log."""
        first = int(rng.integers(len(self._kept) - count))
        kept = self._kept[first : first + count]
        return Leg(self._drive.odometry[kept], [self._drive.scans[k] for k in kept], self._truth[kept])
