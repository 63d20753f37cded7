"""The configuration of a follow environment."""

import math
import os
from collections.abc import Collection, Mapping
from dataclasses import dataclass, fields
from typing import Annotated, Any

from ..slam.bounds import Cell, Within
from ..slam.errors import InputError, shown, unknown_name
from .limits.field_checks import PIXELS, Beams, MapCells, Opening, Patience, People, Rate, Slots, check_fields
from .sensors.lidar import LaserRange

PEOPLE_SOURCES = ("tracker", "camera", "truth")
SENSORS = ("lidar", "rgbd")
MAPPINGS = ("occupancy", "immobile")
_MOST_NAMES = 100  # there are two; who names one twice is forgiven
SLAM_SOURCES = ("gmapping", "cartographer", "ekf", "truth", None)


@dataclass(frozen=True, kw_only=True)
class FollowConfig:
    """Everything that defines an environment; its fields are the keyword arguments of `FollowEnv`.

    Attributes:
        scene: Building: "corridor", "floor_plan", "lab", "landmarks", "meeting_room", "office" or "plain_corridor"; or
            one of Follow-Bench's situations: "narrow_corridor", "doorway", "intersection", "clutter".
        split: Of which half offices are drawn: "train" or "test"; no building of one is ever in the other.
        floor_plan: File `map.yaml` of a ROS map for the scene "floor_plan"; None takes a built-in plan.
        walking_paths: File of recorded walks (`frame id x y` or the `obsmat` form of the ETH and UCY recordings, plain
            or gzip); bystanders walk as in it. None leaves them to the scene.
        people: How people reach the robot's mind: "tracker" by their legs in the scans and, if there is a camera, by
            what it sees; "camera" by that alone; "truth" from the simulator.
        slam: Who builds the map: "gmapping", "cartographer", "ekf" (round landmarks; posts of 0.1 m radius), "truth"
            (known poses, an upper bound), None for no map at all.
        mapping: What the map holds: "occupancy", or "immobile" area by laser and camera, which needs `slam`.
        leader: Whether somebody leads the robot; else it explores, and the episode is about coverage.
        people_count: Walking people in the building, the leader included; may be 0 without one.
        standing: Further people who come to stand still beside the route.
        leader_style: Manner of the leader: "steady", "hurried", "waits"; None draws one from the seed.
        odometry: Quality of the wheel odometry: "perfect", "good", "typical", "slipping".
        drive: "differential" or "holonomic".
        top_turn_rate: Turn rate at action +1 [rad/s], at most the robot's 4; forward speed at action +1 is
            the robot's 1.3 m/s.
        beams: Beams of the laser.
        field_of_view: Angle between its first and its last beam [rad].
        laser_range: Its range [m].
        lidar_hz: Scans a second [1/s]; a multiple of `control_hz`.
        sensors: Which sensors there are: "lidar" always, and "rgbd" for the camera and its observations.
        camera_pixels: Columns and rows of the camera.
        camera_hz: Frames a second [1/s]; the time between two must be a multiple of 0.025 s.
        control_hz: Steps a second [1/s]; a step must be a multiple of 0.025 s.
        people_slots: Most people in observation `people`; the nearest are kept.
        map_cells: Side of observation `map` [cells].
        map_resolution: Side of a cell of observation `map` [m].
        lost_limit_s: The episode ends when the leader was not followed for this long [s].
        coverage: Whether the share of the floor that was seen is measured behind a leader, too.
        coverage_goal: Without a leader, the episode ends when this share of the floor was seen [0 .. 1].
        ends_on_contact: Whether the episode ends when the robot touches a person or a thing.
    """

    scene: str = "corridor"
    split: str = "train"
    floor_plan: str | os.PathLike[str] | None = None
    walking_paths: str | os.PathLike[str] | None = None
    people: str = "tracker"
    slam: str | None = "gmapping"
    mapping: str = "occupancy"
    leader: bool = True
    people_count: People | None = 2
    standing: People = 0
    leader_style: str | None = None
    odometry: str = "typical"
    drive: str = "differential"
    top_turn_rate: Annotated[float, Within(1e-3, 4.0)] = 2.0
    beams: Beams = 1081
    field_of_view: Opening = 1.5 * math.pi
    laser_range: LaserRange = 30.0
    lidar_hz: Rate = 10.0
    sensors: Collection[str] = ("lidar",)
    camera_pixels: Annotated[tuple[int, int], PIXELS] = (128, 106)
    camera_hz: Rate = 10.0
    control_hz: Rate = 10.0
    people_slots: Slots = 6
    map_cells: MapCells = 64
    map_resolution: Cell = 0.1
    lost_limit_s: Patience = 20.0
    coverage: bool = False
    coverage_goal: Annotated[float, Within(1e-6, 1.0)] = 0.99
    ends_on_contact: bool = True

    def __post_init__(self) -> None:
        if isinstance(self.people, int):
            raise InputError(f"`people` says how people are perceived, got {shown(self.people)}; see `people_count`")
        check_fields(self)
        if self.people not in PEOPLE_SOURCES:
            raise InputError(
                f"`people` says how people are perceived, one of {', '.join(PEOPLE_SOURCES)}; got {self.people!r} "
                "(their number is `people_count`)"
            )
        if self.slam not in SLAM_SOURCES:
            raise unknown_name("slam source", self.slam, tuple(str(name) for name in SLAM_SOURCES))
        if self.mapping not in MAPPINGS:
            raise unknown_name("mapping", self.mapping, MAPPINGS)
        if self.mapping == "immobile" and self.slam is None:
            raise InputError('`mapping="immobile"` needs poses: choose a `slam` other than None')
        object.__setattr__(self, "sensors", _names(self.sensors))
        for name in self.sensors:
            if name not in SENSORS:
                raise unknown_name("sensor", name, SENSORS)
        if "lidar" not in self.sensors:
            raise InputError(f'`sensors` must hold "lidar", which the robot cannot do without, got {self.sensors}')
        if self.people == "camera" and "rgbd" not in self.sensors:
            raise InputError(f'`people="camera"` needs "rgbd" among `sensors`, got {self.sensors}')
        if self.leader and self.people_count == 0:
            raise InputError("`people_count` counts the leader: with one it must be at least 1, got 0")
        if abs(self.lidar_hz / self.control_hz - max(1, round(self.lidar_hz / self.control_hz))) > 1e-9:
            raise InputError(
                f"`lidar_hz` must be a whole multiple of `control_hz`, got {self.lidar_hz} and {self.control_hz}"
            )


def _names(sensors: Any) -> tuple[str, ...]:
    """Return the names of sensors in their order, each once."""
    names = (sensors,) if isinstance(sensors, str) else sensors
    plain = isinstance(names, list | tuple | set | frozenset) and len(names) <= _MOST_NAMES
    if not plain or not all(isinstance(name, str) for name in names):
        raise InputError(
            f"`sensors` must be a list of names, one or more of {', '.join(SENSORS)}, got {shown(sensors)}"
        )
    return tuple(sorted(set(names)))


def make_config(arguments: Mapping[str, Any]) -> FollowConfig:
    """Return the configuration with `arguments` as fields.

    Raises:
        InputError: If one is unknown, or a value is out of its range.
    """
    known = tuple(field.name for field in fields(FollowConfig))
    for name in arguments:
        if name not in known:
            raise unknown_name("argument", name, known)
    return FollowConfig(**arguments)
