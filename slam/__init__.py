"""Mapping and localization with a planar laser: scans and odometry in, a trajectory and a map out.

    make_slam(name, **settings)          a SLAM engine: "gmapping", "cartographer" (graph SLAM) or "ekf" (landmarks)
    run_slam(engine, drive) -> SlamRun   a whole recorded drive through an engine: trajectory, map, times
    read_log(path) -> RecordedDrive      a recorded drive: CARMEN, BeeSoft, DP-SLAM and tinySLAM logs, ROS bags
    Deskewer()                           takes the robot's motion out of scans of a laser that spins, as they come
    Localizer(map)                       where on a finished map the robot is, from nowhere or "not sure"
    make_matcher(name, **settings)       the pose of one scan in the frame of another: "plicp", "mbicp", "ndt", ...
    write_ros_map, read_ros_map          maps as ROS's map_server reads them
    score_map, absolute_error            how good a map (ADNN) and a trajectory (ATE) are

What goes in and out is `LaserScan`, `OccupancyMap` and poses `(x, y, theta)` in metres and radians; `T_map_robot` maps
what is told in the robot's frame to the map's. Errors of the caller are `InputError`, one line each.

    >>> import numpy as np
    >>> from tagalong.slam import LaserScan, make_slam
    >>> bearings = np.linspace(-np.pi, np.pi, 180, endpoint=False)
    >>> walls = np.minimum(3.0 / np.maximum(abs(np.cos(bearings)), 1e-9), 2.0 / np.maximum(abs(np.sin(bearings)), 1e-9))
    >>> engine = make_slam("gmapping", particles=5, seed=0)
    >>> update = engine.update([0.0, 0.0, 0.0], LaserScan(walls, bearings, range_min=0.1, range_max=10.0))
    >>> update.integrated, engine.trajectory().shape
    (True, (1, 3))

An engine of one's own is any class with the verbs of `SlamEngine`; its `update` returns a `SlamUpdate`. The settings of
ours are `GMappingConfig`, `CartographerConfig` and `EkfSlamConfig`. Names that are not listed here are private and may
change at any time; so may every module below this package.
"""

from typing import TYPE_CHECKING

from .door import lends

if TYPE_CHECKING:
    from .drives.live_deskewing import Deskewer
    from .drives.log import read_log
    from .ekf.config import EkfSlamConfig
    from .engine import SlamEngine, SlamUpdate, make_slam
    from .errors import InputError
    from .gmapping.config import GMappingConfig
    from .graph.engine import CartographerConfig
    from .localization.localizer import Localizer
    from .logs.drive import RecordedDrive
    from .logs.ros_map import read_ros_map, write_ros_map
    from .occupancy_map import OccupancyMap
    from .quality.score import score_map
    from .quality.trajectory import absolute_error
    from .runner import SlamRun, run_slam
    from .scan import LaserScan
    from .scan_to_scan.matchers import make_matcher

__all__ = [
    "CartographerConfig",
    "Deskewer",
    "EkfSlamConfig",
    "GMappingConfig",
    "InputError",
    "LaserScan",
    "Localizer",
    "OccupancyMap",
    "RecordedDrive",
    "SlamEngine",
    "SlamRun",
    "SlamUpdate",
    "absolute_error",
    "make_matcher",
    "make_slam",
    "read_log",
    "read_ros_map",
    "run_slam",
    "score_map",
    "write_ros_map",
]

_HOME = {
    "CartographerConfig": "graph.engine",
    "Deskewer": "drives.live_deskewing",
    "EkfSlamConfig": "ekf.config",
    "GMappingConfig": "gmapping.config",
    "InputError": "errors",
    "LaserScan": "scan",
    "Localizer": "localization.localizer",
    "OccupancyMap": "occupancy_map",
    "RecordedDrive": "logs.drive",
    "SlamEngine": "engine",
    "SlamRun": "runner",
    "SlamUpdate": "engine",
    "absolute_error": "quality.trajectory",
    "make_matcher": "scan_to_scan.matchers",
    "make_slam": "engine",
    "read_log": "drives.log",
    "read_ros_map": "logs.ros_map",
    "run_slam": "runner",
    "score_map": "quality.score",
    "write_ros_map": "logs.ros_map",
}
"""Public name -> module; imported when it is asked for."""

__getattr__, __dir__ = lends(__name__, _HOME)
