"""`tagalong slam --mapping immobile`: what laser and camera of one bag say, as one map of what never moves."""

import argparse
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ...perception.immobile.mapper import ImmobileMapperConfig
from ...perception.immobile.slam import ImmobileSlam, ImmobileSlamConfig
from ...perception.immobile.view import CameraView, CameraViewMaker
from ...perception.legs.forest import LegForest
from ...perception.people_filter import PeopleFilterConfig
from ...perception.rgbd.bag_frames import has_frames, read_bag_frames
from ...perception.rgbd.bag_topics import CameraTopics
from ...perception.rgbd.people_finder import PeopleFinder
from ...slam.engine import SlamEngine
from ...slam.errors import InputError
from ...slam.immobile.layers import LayersConfig
from ...slam.logs.drive import RecordedDrive
from ...slam.logs.ros_map import write_ros_map
from ..console.arguments import HIGHEST_M, within

OWN, IMMOBILE = "own", "immobile"
MAPPINGS = (OWN, IMMOBILE)
_CLOCKS_S = 5.0
"""Frames whose headers are farther than this from the drive are of another clock: the recorder's time is taken [s]."""
_EVERY_S = 0.1
_HIGHEST_M = 100.0


def add_mapping_options(parser: argparse.ArgumentParser) -> None:
    """Declare the options of the immobile-area map."""
    group = parser.add_argument_group("of the map of what never moves (--mapping immobile)")
    group.add_argument(
        "--mapping",
        choices=MAPPINGS,
        default=OWN,
        help="the engine's own map, or that of immobile area, by laser and, if the bag has one, RGB-D camera; "
        "--method immobile lets the map itself localize (default: %(default)s)",
    )
    group.add_argument(
        "--laser-height", type=within(0.01, HIGHEST_M), metavar="M", help="above the floor (default: 0.32)"
    )
    group.add_argument(
        "--camera-height", type=within(0.01, HIGHEST_M), metavar="M", help="above the floor, within 0.15 m or so"
    )
    group.add_argument(
        "--camera-every", type=within(0.0, 3600.0), metavar="S", help="leave out frames that follow sooner [s] (0.1)"
    )
    group.add_argument("--depth-topic", metavar="NAME", help="of a bag with several topics of depth pictures")
    group.add_argument("--colour-topic", metavar="NAME", help="of a bag with several topics of colour pictures")
    group.add_argument("--camera-info-topic", metavar="NAME", help="of a bag with several topics of intrinsics")


def check_mapping(options: argparse.Namespace) -> None:
    """Complain of options that do not go together, before the log is read.

    Raises:
        InputError: Naming them.
    """
    camera = ("laser_height", "camera_height", "camera_every", "depth_topic", "colour_topic", "camera_info_topic")
    if options.mapping == OWN:
        given = [name for name in camera if getattr(options, name) is not None]
        if given or options.method == IMMOBILE:
            name = f"--{given[0].replace('_', '-')}" if given else "--method immobile"
            raise InputError(f"{name} is of the immobile-area map: give --mapping immobile, too")
        return
    if options.filter_people:
        raise InputError("--filter-people is of the engine's own map; --mapping immobile keeps people out by itself")
    LegForest.load(options.forest or "real")
    _grid(options)


def immobile_slam(options: argparse.Namespace, drive: RecordedDrive, engine: SlamEngine | None) -> ImmobileSlam:
    """Return what maps the drive in `options.log`; `engine` says where the robot is, None: the map itself.

    Raises:
        InputError: If the times of its scans do not increase.
    """
    if not (np.diff(drive.times_s) > 0.0).all():
        raise InputError(f"{options.log}: --mapping immobile needs scans whose times increase")
    config = ImmobileSlamConfig(
        mapper=ImmobileMapperConfig(grid=_grid(options)), people=PeopleFilterConfig(forest=options.forest or "real")
    )
    views = _views(options, drive) if has_frames(options.log) else iter(())
    return ImmobileSlam(views, config, engine)


def write_layers(folder: Path, mapped: ImmobileSlam) -> dict[str, Any]:
    """Write the map of movable things beside the other; return what metrics.json says of the views."""
    write_ros_map(folder / "movable", mapped.mapper.grid.movable())
    return {"views": mapped.views_written}


def _grid(options: argparse.Namespace) -> LayersConfig:
    config = LayersConfig(clear_no_return=True)
    if options.laser_height is not None:
        config = replace(config, laser_height=options.laser_height)
    return config if options.resolution is None else replace(config, resolution=options.resolution)


def _views(options: argparse.Namespace, drive: RecordedDrive) -> Iterator[CameraView]:
    """Yield what the camera says, in the time of the drive."""
    topics = CameraTopics(depth=options.depth_topic, colour=options.colour_topic, depth_info=options.camera_info_topic)
    every_s = _EVERY_S if options.camera_every is None else options.camera_every
    maker, last_s = CameraViewMaker(PeopleFinder.load()), -np.inf
    start_s, end_s = drive.times_s[0] - _CLOCKS_S, drive.times_s[-1] + _CLOCKS_S
    for recorded in read_bag_frames(options.log, topics, every_s):
        frame = recorded.frame
        time_s = frame.time_s if start_s <= frame.time_s <= end_s else float(recorded.notes["recorded_s"])
        if time_s > last_s:
            last_s = time_s
            yield maker.make(replace(frame, time_s=time_s, camera_height=options.camera_height))
