"""The configuration of one episode's simulator."""

import os
from dataclasses import dataclass, field
from typing import Annotated

from ...slam.bounds import Share, Within
from ...slam.errors import InputError, unknown_name
from ..limits.field_checks import People, Rate, check_fields
from ..people.behaviours.behaviour import Behaviour, checked_behaviours
from ..people.behaviours.leader import STYLES
from ..people.movement.social_force import SocialForceConfig
from ..robot.odometry import QUALITIES, OdometryConfig
from ..robot.robot import RobotConfig
from ..scenes.catalogue import check_scene_name
from ..scenes.request import SceneMaker, SceneRequest
from ..sensors.camera.config import RgbdConfig
from ..sensors.lidar import LidarConfig

TICK = 0.025
"""Time between two updates of people, odometry and laser [s]; control and laser periods are multiples of it."""


@dataclass(frozen=True, kw_only=True)
class WorldConfig:
    """What to simulate.

    Attributes:
        scene: Kind of the building, see `tagalong.envs.scenes.SCENES`, or a function that draws one of one's own.
        route: Name of the tour, None draws one.
        split: Of which half offices are drawn: "train" or "test".
        floor_plan: File `map.yaml` for the scene "floor_plan"; None takes the built-in plan.
        walking_paths: File of recorded walks in the form of the ETH and UCY recordings; bystanders walk as in it. None
            leaves them to the scene.
        people: Number of walking people, the leader included; None draws 0 to 12 beside the leader where people have
            ways of their own, as in offices, else 0 to 3.
        leader: Whether the first of the people leads the robot. Without, all are bystanders: the same as with a
            leader and one person more.
        leader_style: "steady", "hurried" or "waits" (when the robot lags); None draws one.
        standing: Number of further people who walk to and fro beside the route and stand still for 25 s once the
            robot has come near.
        heedless: Share of the bystanders who do not see the robot.
        behaviours: Further people, one for each behaviour, see `tagalong.envs.people`. Each begins with a
            copy of the object that stands here, where it says, or at a drawn place of the route.
        odometry: Name of a quality, see `QUALITIES`, or a configuration.
        lidar: The laser scanner.
        camera: The RGB-D camera; None for none. With one, clothing, paint and light are drawn too.
        robot: The robot.
        force: The social force between people.
        control_hz: Commands per second [Hz].
        physics_dt: Time step of the physics [s].
    """

    scene: str | SceneMaker = "corridor"
    route: str | None = None
    split: str = "train"
    floor_plan: str | os.PathLike[str] | None = None
    walking_paths: str | os.PathLike[str] | None = None
    people: People | None = 2
    leader: bool = True
    leader_style: str | None = None
    standing: People = 0
    heedless: Share = 0.0
    behaviours: tuple[Behaviour, ...] = ()
    odometry: str | OdometryConfig = "typical"
    lidar: LidarConfig = field(default_factory=LidarConfig)
    camera: RgbdConfig | None = None
    robot: RobotConfig = field(default_factory=RobotConfig)
    force: SocialForceConfig = field(default_factory=SocialForceConfig)
    control_hz: Rate = 10.0
    physics_dt: Annotated[float, Within(1e-4, TICK)] = 0.0125

    def __post_init__(self) -> None:
        check_fields(self)
        object.__setattr__(self, "behaviours", checked_behaviours(self.behaviours))
        check_scene_name(self.scene)
        if self.leader_style is not None and self.leader_style not in STYLES:
            raise unknown_name("leader style", self.leader_style, tuple(STYLES))
        if isinstance(self.odometry, str) and self.odometry not in QUALITIES:
            raise unknown_name("odometry quality", self.odometry, tuple(QUALITIES))
        self.request()
        whole_ratio("the control period 1 / `control_hz`", 1.0 / self.control_hz, TICK)
        whole_ratio("the laser's period 1 / `rate_hz`", 1.0 / self.lidar.rate_hz, TICK)
        if self.camera is not None:
            whole_ratio("the camera's period 1 / `rate_hz`", 1.0 / self.camera.rate_hz, TICK)
        whole_ratio("the simulation's tick", TICK, self.physics_dt)

    def request(self) -> SceneRequest:
        """Return what is asked of the scene."""
        return SceneRequest(route=self.route, split=self.split, floor_plan=self.floor_plan)


def whole_ratio(what: str, long: float, short: float) -> int:
    """Return `long` / `short`, both in seconds.

    Raises:
        InputError: If that is not a whole number of at least 1; `what` names `long`.
    """
    ratio = round(long / short) if short > 0.0 else 0
    if ratio < 1 or abs(ratio * short - long) > 1e-9:
        raise InputError(f"{what} must be a whole multiple of {short} s, got {long} s")
    return ratio
