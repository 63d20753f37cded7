"""From a configuration and reset options to a world and an onboard stack."""

import math
from collections.abc import Mapping
from numbers import Integral
from typing import Any

import numpy as np

from ..perception.immobile.view import CameraViewMaker
from ..perception.leader.selector import LeaderSelector
from ..perception.legs.detector import LegDetector
from ..perception.legs.forest import LegForest
from ..perception.people_filter import PeopleFilter
from ..perception.rgbd.people import NoPeopleFinder, RgbdPeopleFinder
from ..perception.rgbd.people_finder import PeopleFinder
from ..perception.tracking.camera import NoLegs
from ..slam.errors import InputError, shown, unknown_name
from .follow_config import FollowConfig
from .onboard.camera_pipeline import CameraPipeline, NoCamera, RgbdPipeline
from .onboard.engines import BY_IMMOBILE_MAP, TRUE_POSES, make_engine
from .onboard.immobile_map import Drawing, ImmobileDrawing, ImmobileMapLocalization, OwnDrawing
from .onboard.mappers import Mapper, NoMapper, SlamMapper
from .onboard.stack import NobodyLeads, OnboardStack, PeopleSource, Selector
from .oracle import ModelledPeopleSource, TrueMapper, TruePeopleSource, TrueRgbdPeopleFinder
from .task.interface import FollowInterface
from .task.observation import Observed
from .tracker_errors.errors import chosen_errors
from .world.world import World, WorldConfig

OPTIONS = ("scene", "split", "route", "people", "standing", "leader_style", "heedless", "odometry")
"""Options of `reset`: fields of `WorldConfig` that they set for one episode."""


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
    world, people = config.world, config.people
    fields: dict[str, Any] = {
        "scene": world.scene,
        "split": world.split,
        "floor_plan": world.floor_plan,
        "walking_paths": world.walking_paths,
        "people": people.people_count,
        "leader": config.task.leader,
        "standing": people.standing,
        "leader_style": people.leader_style,
        "heedless": people.heedless,
        "behaviours": people.behaviours,
        "odometry": config.sensors.odometry,
    }
    made = WorldConfig(
        **{**fields, **(options or {})},
        lidar=config.sensors.lidar,
        camera=config.sensors.camera,
        robot=config.robot,
        control_hz=config.task.control_hz,
    )
    if config.task.leader and made.people == 0:
        raise InputError("option `people` counts the leader: with one it must be at least 1, got 0")
    return made


def interface(config: FollowConfig) -> FollowInterface:
    """Return the scales of the environment's observations and actions, and the robot's size."""
    lidar, robot = config.sensors.lidar, config.robot
    return FollowInterface(
        max_speed=robot.max_speed,
        max_turn_rate=config.task.top_turn_rate,
        control_hz=config.task.control_hz,
        holonomic=robot.holonomic,
        bearings=lidar.bearings,
        range_max=lidar.range_max,
        T_robot_lidar=lidar.mount,
        half_length=math.ceil(500.0 * robot.size[0]) / 1000.0,
        half_width=math.ceil(500.0 * robot.size[1]) / 1000.0,
    )


def observed(config: FollowConfig) -> Observed:
    """Return what there is to observe."""
    return Observed(
        config=config.observation,
        beams=config.sensors.lidar.beams,
        holonomic=config.robot.holonomic,
        leader=config.task.leader,
        map=config.slam is not None,
        camera=config.sensors.camera,
    )


class OnboardStackFactory:
    """Makes a fresh onboard stack for each episode; the forest of the leg detector is loaded once."""

    def __init__(self, config: FollowConfig) -> None:
        self._config, self._source = config, config.people.source
        self._perception = config.perception
        self._forest = LegForest.load(config.perception.forest) if self._source == "tracker" else None
        self._errors = chosen_errors(config.people.tracker_errors) if self._source == "modelled" else None
        self._by_truth = self._source in ("truth", "modelled")
        found = config.sensors.camera is not None and not self._by_truth
        self._looks = found or (config.sensors.camera is not None and config.mapping.map == "immobile")
        self._finder: RgbdPeopleFinder = PeopleFinder.load() if found else NoPeopleFinder()

    @property
    def shared(self) -> dict[int, Any]:
        """What onboard stacks share and never change, as a memo for `copy.deepcopy`."""
        return {id(self._forest): self._forest, id(self._finder): self._finder}

    def make(self, world: World, rng: np.random.Generator) -> OnboardStack:
        """Return a stack that knows nothing yet; its SLAM and its errors of people draw from streams of their own."""
        mapping, erring = np.random.SeedSequence(int(rng.integers(2**31))).spawn(2)
        drawing, sight = self._drawing(world), self._sight(world)
        mapper = self._mapper(world, mapping, drawing)
        people, selector = self._people(world, erring), self._selector()
        return OnboardStack(people, selector, mapper, drawing, sight, self._config.mapping.filter_people)

    def _selector(self) -> Selector:
        if not self._config.task.leader:
            return NobodyLeads()
        return LeaderSelector(self._perception.leader, self._perception.tracker.motion)

    def _drawing(self, world: World) -> Drawing:
        if self._config.mapping.map == "occupancy":
            return OwnDrawing()
        revises = self._config.slam not in (TRUE_POSES, BY_IMMOBILE_MAP)
        return ImmobileDrawing(world.config.lidar.height, redrawable=revises)

    def _sight(self, world: World) -> CameraPipeline:
        if not self._looks:
            return NoCamera()
        return RgbdPipeline(CameraViewMaker(TrueRgbdPeopleFinder(world) if self._by_truth else self._finder))

    def _people(self, world: World, erring: np.random.SeedSequence) -> PeopleSource:
        p = self._perception
        if self._errors is not None:
            return ModelledPeopleSource(world, p.removal, self._errors, np.random.default_rng(erring))
        if self._source == "truth":
            return TruePeopleSource(world, p.removal)
        detector = NoLegs() if self._forest is None else LegDetector(self._forest, p.detector)
        return PeopleFilter(p, detector)

    def _mapper(self, world: World, seed: np.random.SeedSequence, drawing: Drawing) -> Mapper:
        if self._config.slam is None:
            return NoMapper()
        if self._config.slam == TRUE_POSES:
            return TrueMapper(world)
        if self._config.slam == BY_IMMOBILE_MAP and isinstance(drawing, ImmobileDrawing):
            return ImmobileMapLocalization(drawing.mapper)
        return SlamMapper(make_engine(self._config.slam, seed))
