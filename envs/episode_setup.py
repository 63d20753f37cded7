"""From a configuration and reset options to a world and a mind."""

from collections.abc import Mapping
from numbers import Integral
from typing import Any

import numpy as np

from ..perception.config import PerceptionConfig
from ..perception.immobile.view import CameraViewMaker
from ..perception.leader.body_selector import BodyLeaderSelector
from ..perception.leader.selector import LeaderSelector
from ..perception.legs.detector import LegDetector, LegDetectorConfig
from ..perception.legs.forest import LegForest
from ..perception.people_filter import PeopleFilter
from ..perception.rgbd.people import NoPeopleFinder, RgbdPeopleFinder
from ..perception.rgbd.people_finder import PeopleFinder
from ..perception.tracking.camera import NoLegs
from ..slam.ekf.engine import EkfSlam
from ..slam.errors import InputError, shown, unknown_name
from ..slam.gmapping.engine import GMapping
from ..slam.graph.engine import Cartographer
from .follow_config import FollowConfig
from .interface import FollowInterface
from .onboard.camera_pipeline import CameraPipeline, NoCamera, RgbdPipeline
from .onboard.immobile_map import Drawing, ImmobileDrawing, OwnDrawing
from .onboard.mappers import EngineMapper, GraphMapper, Mapper, NoMapper
from .onboard.stack import NobodyLeads, OnboardStack, PeopleSource, Selector
from .oracle import TrueMapper, TruePeopleSource, TrueRgbdPeopleFinder
from .robot.robot import RobotConfig
from .sensors.camera.config import RgbdConfig
from .sensors.lidar import LidarConfig
from .world.world import World, WorldConfig

OPTIONS = ("scene", "split", "route", "people", "standing", "leader_style", "odometry")
"""Options of `reset`: fields of `WorldConfig` that they set for one episode."""

FAR_WIDTH_M = 0.12
"""A cluster needs as many points as a leg of this width gets beams, 2 or 3, by distance and spacing of the beams: 2
from 3.1 m on with 360 beams, from 9.2 m on with 1081. What that gains: `scripts/experiments/recall_by_distance.py`."""

PERCEPTION = PerceptionConfig(forest="simulation", detector=LegDetectorConfig(far_width=FAR_WIDTH_M))
"""How the robot of the environments perceives people."""


def check_options(options: Mapping[str, Any] | None) -> None:
    """Refuse options of `reset` that do not exist.

    Raises:
        InputError: Naming the option and those that exist.
    """
    if options is not None and not isinstance(options, Mapping):
        raise InputError(f"reset options are a table of names and values, got {shown(options)}")
    for name in options or ():
        if name not in OPTIONS:
            raise unknown_name("reset option", name, OPTIONS)


def checked_seed(seed: int | None) -> int | None:
    """Return a seed as Gymnasium takes it.

    Raises:
        InputError: If it is no whole number from 0 to 2^64 - 1: larger ones tell nothing more apart.
    """
    if seed is None:
        return None
    if not isinstance(seed, Integral) or isinstance(seed, bool) or not 0 <= seed < 2**64:
        raise InputError(f"`seed` must be a whole number within 0 .. 2^64 - 1, got {shown(seed)}")
    return int(seed)


def world_config(config: FollowConfig, options: Mapping[str, Any] | None) -> WorldConfig:
    """Return the world's configuration for one episode.

    Raises:
        InputError: If a value is out of its range.
    """
    robot = RobotConfig(drive=config.drive)
    fields: dict[str, Any] = {
        "scene": config.scene,
        "split": config.split,
        "floor_plan": config.floor_plan,
        "walking_paths": config.walking_paths,
        "people": config.people_count,
        "leader": config.leader,
        "standing": config.standing,
        "leader_style": config.leader_style,
        "odometry": config.odometry,
    }
    made = WorldConfig(
        **{**fields, **(options or {})},
        lidar=lidar_config(config),
        camera=camera_config(config),
        robot=robot,
        control_hz=config.control_hz,
    )
    if config.leader and made.people == 0:
        raise InputError("option `people` counts the leader: with one it must be at least 1, got 0")
    return made


def lidar_config(config: FollowConfig) -> LidarConfig:
    """Return the laser's configuration."""
    return LidarConfig(
        beams=config.beams,
        field_of_view=config.field_of_view,
        range_max=config.laser_range,
        rate_hz=config.lidar_hz,
    )


def camera_config(config: FollowConfig) -> RgbdConfig | None:
    """Return the camera's configuration, None without a camera."""
    if "rgbd" not in config.sensors:
        return None
    width, height = config.camera_pixels
    return RgbdConfig(width=width, height=height, rate_hz=config.camera_hz)


def interface(config: FollowConfig) -> FollowInterface:
    """Return the scales of the environment's observations and actions."""
    lidar = lidar_config(config)
    return FollowInterface(
        max_speed=RobotConfig().max_speed,
        max_turn_rate=config.top_turn_rate,
        control_hz=config.control_hz,
        holonomic=config.drive == "holonomic",
        bearings=lidar.bearings,
        range_max=lidar.range_max,
        T_robot_lidar=lidar.mount,
    )


class OnboardStackFactory:
    """Makes a fresh mind for each episode; the forest of the leg detector is loaded once."""

    def __init__(self, config: FollowConfig) -> None:
        self._config = config
        self._perception = PERCEPTION
        self._forest = LegForest.load(PERCEPTION.forest) if config.people == "tracker" else None
        self._looks = "rgbd" in config.sensors and (config.people != "truth" or config.mapping == "immobile")
        found = self._looks and config.people != "truth"
        self._finder: RgbdPeopleFinder = PeopleFinder.load() if found else NoPeopleFinder()

    @property
    def shared(self) -> dict[int, Any]:
        """What minds share and never change, as a memo for `copy.deepcopy`."""
        return {id(self._forest): self._forest, id(self._finder): self._finder}

    def make(self, world: World, rng: np.random.Generator) -> OnboardStack:
        """Return a mind that knows nothing yet; its leader's cloud and its SLAM draw from streams of their own."""
        leading = np.random.SeedSequence(int(rng.integers(2**31)))
        (mapping,) = leading.spawn(1)
        mapper, drawing, sight = self._mapper(world, mapping), self._drawing(world), self._sight(world)
        return OnboardStack(self._people(world), self._selector(leading), mapper, drawing, sight)

    def _selector(self, seed: np.random.SeedSequence) -> Selector:
        if not self._config.leader:
            return NobodyLeads()
        p = self._perception
        if self._forest is None:  # known by truth, by one number for ever, or without any legs
            return LeaderSelector(p.leader, p.tracker.motion)
        return BodyLeaderSelector(np.random.default_rng(seed), p.body, p.leader)

    def _drawing(self, world: World) -> Drawing:
        return OwnDrawing() if self._config.mapping == "occupancy" else ImmobileDrawing(world.config.lidar.height)

    def _sight(self, world: World) -> CameraPipeline:
        if not self._looks:
            return NoCamera()
        return RgbdPipeline(
            CameraViewMaker(TrueRgbdPeopleFinder(world) if self._config.people == "truth" else self._finder)
        )

    def _people(self, world: World) -> PeopleSource:
        if self._config.people == "truth":
            return TruePeopleSource(world, self._perception.removal)
        p = self._perception
        detector = NoLegs() if self._forest is None else LegDetector(self._forest, p.detector)
        return PeopleFilter(p, detector)

    def _mapper(self, world: World, seed: np.random.SeedSequence) -> Mapper:
        if self._config.slam is None:
            return NoMapper()
        if self._config.slam == "truth":
            return TrueMapper(world)
        if self._config.slam == "cartographer":
            return GraphMapper(Cartographer())
        if self._config.slam == "ekf":
            return GraphMapper(EkfSlam())
        return EngineMapper(GMapping(seed=seed))
