"""The configuration of a follow environment: a tree, each branch of which stands beside what it configures."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from ..perception.config import PerceptionConfig
from ..slam.errors import InputError
from .limits.arguments import argument_names, branch, with_arguments
from .limits.field_checks import check_fields
from .onboard.config import PERCEPTION, MappingConfig
from .onboard.engines import BY_IMMOBILE_MAP, SLAM, SlamChoice, check_slam
from .people.config import PeopleConfig
from .robot.robot import ROBOTS, RobotConfig
from .scenes.config import SceneConfig
from .sensors.config import SensorsConfig
from .task.config import TaskConfig
from .task.observation import ObservationConfig
from .task.rewards import RewardConfig


@dataclass(frozen=True, kw_only=True)
class FollowConfig:
    """Everything that defines an environment; `make_config` makes one of the keyword arguments of `FollowEnv`.

    Attributes:
        world: The building.
        robot: Size and limits of the robot: "dingo-d", "dingo-o", "pioneer", or its numbers.
        sensors: Laser, camera and wheel odometry.
        people: The people; as a text, how they reach the onboard stack: "tracker", "camera", "truth",
            "modelled".
        perception: Numbers of leg detector, tracker and people filter.
        slam: Who builds the map: "gmapping", "cartographer", "ekf" (round landmarks; posts of 0.1 m radius), the
            configuration of one of these, a function that makes an engine of a seed (`numpy.random.SeedSequence`),
            "immobile" (the immobile map by itself: each scan is matched on what earlier ones drew), "truth" (known
            poses, an upper bound), None for no map at all.
        mapping: What the map is made of; as a text, what it holds: "occupancy", "immobile".
        reward: Weights of the reward's terms, and further terms.
        observation: Sizes of the observation's entries, and further entries.
        task: What is asked of the robot.
    """

    world: SceneConfig = field(default=SceneConfig(), metadata=branch(chooses="scene"))
    robot: RobotConfig = field(default=RobotConfig(), metadata=branch(choices=ROBOTS, title="robot"))
    sensors: SensorsConfig = field(default=SensorsConfig(), metadata=branch())
    people: PeopleConfig = field(default=PeopleConfig(), metadata=branch(chooses="source"))
    perception: PerceptionConfig = field(default=PERCEPTION, metadata=branch(foreign=True))
    slam: SlamChoice = field(default=SLAM["gmapping"], metadata=branch(choices=SLAM, title="SLAM engine", foreign=True))
    mapping: MappingConfig = field(default=MappingConfig(), metadata=branch(chooses="map"))
    reward: RewardConfig = field(default=RewardConfig(), metadata=branch(by_path=True))
    observation: ObservationConfig = field(default=ObservationConfig(), metadata=branch())
    task: TaskConfig = field(default=TaskConfig(), metadata=branch())

    def __post_init__(self) -> None:
        check_fields(self)
        check_slam(self.slam)
        if self.mapping.map == "immobile" and self.slam is None:
            raise InputError('`mapping="immobile"` needs poses: choose a `slam` other than None')
        if self.slam == BY_IMMOBILE_MAP and self.mapping.map != "immobile":
            raise InputError('`slam="immobile"` localizes by the immobile map: choose `mapping="immobile"`')
        if self.people.source == "camera" and self.sensors.camera is None:
            raise InputError('`people="camera"` needs a camera: choose one, `camera="kinect-v2"`')
        if self.task.leader and self.people.people_count == 0:
            raise InputError("`people_count` counts the leader: with one it must be at least 1, got 0")
        if self.task.top_turn_rate > self.robot.max_turn_rate:
            most = f"the robot's `max_turn_rate`, {self.robot.max_turn_rate:g} rad/s"
            raise InputError(f"`top_turn_rate` must be at most {most}, got {self.task.top_turn_rate}")
        laser, control = self.sensors.lidar.rate_hz, self.task.control_hz
        if abs(laser / control - max(1, round(laser / control))) > 1e-9:
            raise InputError(f"`lidar.rate_hz` must be a whole multiple of `control_hz`, got {laser} and {control}")


ARGUMENTS = argument_names(FollowConfig)
"""The whole path of every argument of `FollowEnv`."""


def make_config(arguments: Mapping[str, Any]) -> FollowConfig:
    """Return the configuration with some settings changed; `tagalong.envs.limits.arguments` says how they are named.

    Raises:
        InputError: If a name is unknown, or a value is out of its range.
    """
    return with_arguments(FollowConfig(), arguments)
