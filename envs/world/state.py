"""What a world is built from, and all that changes in it."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...perception.rgbd.frame import RgbdFrame
from ...slam.scan import LaserScan
from ..people.crowd import Casting, CrowdState
from ..robot.odometry import WheelOdometry
from ..robot.robot import Robot
from ..scenes.scene import Scene
from .config import WorldConfig
from .doors import Doors

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Plan:
    """What was drawn for an episode and never changes in it; with the configuration, all that a world is built from.

    Attributes:
        config: What is simulated.
        scene: The building.
        start: (3,) T_world_robot at the start.
        casting: Who is in the building.
        looks_seed: Seed of clothing, paint and light.
    """

    config: WorldConfig
    scene: Scene
    start: Array
    casting: Casting
    looks_seed: int


@dataclass(eq=False)
class Changing:
    """All that changes in a world, besides the physics; nothing else in a world does.

    A snapshot of a world is a deep copy of this object. Whatever has state is reached from here, and so a part that is
    new, or a behaviour, is saved and restored without being named anywhere else.

    Attributes:
        crowd: The people, their behaviours with what these remember among them.
        doors: The doors.
        robot: The wheels' setpoint.
        odometry: What the wheels believe.
        streams: Random generators, by what they are for.
        progress: Way of the robot along the route [m].
        ticks: Updates since the start.
        contact_person: Whether the robot touched a person in the last control period.
        contact_static: Whether it touched something else.
        scans: The scans of the last control period.
        labels: What the beams of the latest one met.
        frames: The frames of the last control period.
        geoms: What the pixels of the latest one met.
    """

    crowd: CrowdState
    doors: Doors
    robot: Robot
    odometry: WheelOdometry
    streams: dict[str, np.random.Generator]
    progress: float
    ticks: int = 0
    contact_person: bool = False
    contact_static: bool = False
    scans: tuple[LaserScan, ...] = ()
    labels: NDArray[np.int32] = field(default_factory=lambda: np.zeros(0, dtype=np.int32))
    frames: tuple[RgbdFrame, ...] = ()
    geoms: NDArray[np.int32] = field(default_factory=lambda: np.zeros((0, 0), dtype=np.int32))


@dataclass(frozen=True, eq=False)
class WorldState:
    """A snapshot of a world: continuing from it gives the same bytes again.

    Attributes:
        physics: MuJoCo's full integration state.
        changing: All else that changes.
    """

    physics: Array
    changing: Changing
