"""`tagalong localize`: where on a finished map a recorded drive went."""

import argparse
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...slam.ekf.landmark_localizer import LandmarkLocalizer, LandmarkLocalizerConfig
from ...slam.errors import InputError, unknown_name
from ...slam.landmarks.clustering import METHODS as CLUSTERINGS
from ...slam.landmarks.landmark_map import read_landmark_map
from ...slam.localization.localizer import Localizer, LocalizerConfig
from ...slam.localization.runner import DriveLocalizer, LocalizerRun, run_localizer
from ...slam.localization.whole_drive import smooth_drive
from ...slam.logs.beesoft import is_beesoft_map, read_beesoft_map
from ...slam.logs.ros_map import read_ros_map
from ...slam.occupancy_map import OccupancyMap
from ...slam.settings import with_settings
from ..console.arguments import within
from ..console.log_options import add_odometry, add_topics, read_with_odometry
from ..console.setting_words import read_settings
from ..console.tables import format_table
from ..runs.localize_run import write_localize_run
from ..runs.slam_run import prepare_folder, progress_bar

EPILOG = """\
The whole map is searched first, and again whenever the scans contradict the map. All places where the robot may be are
followed until its scans have decided between them. While several remain (a symmetric room, a smooth corridor, one of
many equal doors), or the best explains the scans no better than the unknown would (where the map ends), it is "not
sure": such scans have no pose. At the end the drive is looked at as a whole, also backwards: what the last scans decide
holds for the first ones, too. Odometry that says less than 0.8 or more than 1.25 metres or radians for each one that
the scans show is complained of, in one line on stderr.

On a map of landmarks nothing is searched: the robot is followed from its start, and "not sure" once the filter's
standard deviation exceeds half a metre, or scan after scan shows landmarks that the map does not know. Its file is
  {"landmarks": [{"x": 2.31, "y": -0.84, "covariance": [xx, xy, yy], "seen": 17}, ...]}    in metres; the last two may
be left out; or CSV whose first line is x,y or x,y,xx,xy,yy. tagalong slam --method ekf writes landmarks.json.

writes into DIR:
  trajectory.tum         the scans with a pose: t x y z qx qy qz qw
                         (t: the number of the scan where the log has no usable times)
  smoothed.tum           by the whole drive at once, all scans but where the robot was rather off the map; not on
                         landmarks, nor where no place was found
  map.png                the path on the map, to look at
  metrics.json           share of sure and matched scans, how often the robot was lost, how much the map explains
  timing.json            speed and memory; the only file that differs between two runs

example:
  tagalong slam drive.log.gz --out out/map
  tagalong localize drive.log.gz --map out/map/map.yaml --out out/localized
  tagalong slam posts.log.gz --method ekf --out out/posts
  tagalong localize posts.log.gz --map out/posts/landmarks.json --method landmarks --clustering gmm --out out/again
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.epilog = EPILOG
    parser.add_argument(
        "log",
        type=Path,
        metavar="LOG",
        help="CARMEN, BeeSoft, DP-SLAM or tinySLAM log (plain or .gz), ROS 1 bag, ROS 2 bag folder",
    )
    parser.add_argument(
        "--map",
        type=Path,
        required=True,
        metavar="MAP",
        help="map.yaml of ROS map_server, or a BeeSoft map (.dat); of landmarks: .json or .csv",
    )
    parser.add_argument(
        "--method",
        default="grid",
        help="grid: scans are matched on a grid map; landmarks: a Kalman filter on the landmarks of a map "
        "(default: %(default)s)",
    )
    parser.add_argument(
        "--clustering", metavar="NAME", help=f"of --method landmarks: {', '.join(CLUSTERINGS)} (default: dbscan)"
    )
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        dest="settings",
        help="a field of the localizer's configuration, e.g. patience=5 or sighting.radius=0.2; may be repeated",
    )
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="where the results go")
    parser.add_argument(
        "--start",
        type=within(-1e6, 1e6),
        nargs=3,
        metavar=("X", "Y", "DEG"),
        help="pose on the map at the first scan [m, m, deg]; without it a grid map is searched, and on landmarks the "
        "robot starts where the odometry does",
    )
    add_topics(parser)
    add_odometry(parser)
    parser.add_argument("--quiet", action="store_true", help="no progress bar")


def run(options: argparse.Namespace) -> int:
    """Localize the log, write the results, print a table."""
    start = _start(options.start)
    if options.method not in METHODS:
        raise unknown_name("localization method", options.method, tuple(METHODS))
    localizer, grid = METHODS[options.method](options, start)
    read = read_with_odometry(options)
    drive = read.drive
    prepare_folder(options.out)
    result = run_localizer(localizer, drive, progress=progress_bar(drive.name, not options.quiet))
    smoothed = smooth_drive(localizer, drive) if isinstance(localizer, Localizer) else None
    settings = {
        "map": options.map.name,
        "method": options.method,
        "start": None if start is None else start.tolist(),
        "config": asdict(localizer.config),
        **read.settings,
    }
    metrics = write_localize_run(options.out, drive, result, grid, settings, smoothed)
    print(format_table(("quantity", "value", "unit"), _rows(metrics, result)))
    print(f"written to {options.out}")
    return 0


def _on_grid(options: argparse.Namespace, start: NDArray[np.float64] | None) -> tuple[DriveLocalizer, OccupancyMap]:
    """Return the localizer on a grid map, and that map."""
    if options.clustering is not None:
        raise InputError("--clustering is for --method landmarks")
    config = with_settings(LocalizerConfig(), read_settings(options.settings))
    grid = _read_map(options.map)
    try:
        return Localizer(grid, config, start, keep_history=True), grid
    except InputError as error:
        raise InputError(f"{options.map}: {error}") from error


def _on_landmarks(
    options: argparse.Namespace, start: NDArray[np.float64] | None
) -> tuple[DriveLocalizer, OccupancyMap]:
    """Return the localizer on a map of landmarks, and a picture of that map."""
    settings = read_settings(options.settings)
    if options.clustering is not None:
        settings["clustering"] = options.clustering
    config = with_settings(LandmarkLocalizerConfig(), settings)
    landmarks = read_landmark_map(options.map)
    try:
        return LandmarkLocalizer(landmarks, config, start), landmarks.drawn(config.sighting.radius)
    except InputError as error:
        raise InputError(f"{options.map}: {error}") from error


METHODS = {"grid": _on_grid, "landmarks": _on_landmarks}
"""What localizes, by the kind of its map."""


def _read_map(path: Path) -> OccupancyMap:
    return read_beesoft_map(path) if is_beesoft_map(path) else read_ros_map(path)


def _start(words: list[float] | None) -> NDArray[np.float64] | None:
    if words is None:
        return None
    if not np.isfinite(words).all():
        raise InputError(f"--start needs three finite numbers X Y DEG, got {words}")
    return np.array([words[0], words[1], np.radians(words[2])])


def _rows(metrics: dict[str, Any], result: LocalizerRun) -> list[tuple[str, str, str]]:
    first, explained = metrics["first_sure_scan"], metrics["explained_median"]
    whole = metrics["whole_drive_probability"]
    return [
        ("scans", str(metrics["scans"]), ""),
        ("first sure scan", "never" if first is None else str(first), ""),
        ("sure", f"{100 * metrics['sure_share']:.1f}", "%"),
        ("matched", f"{100 * metrics['matched_share']:.1f}", "%"),
        ("lost", str(metrics["lost"]), "times"),
        ("whole drive sure", "-" if whole is None else f"{100 * whole:.1f}", "%"),
        ("whole drive on the map", "-" if whole is None else f"{100 * metrics['whole_drive_share']:.1f}", "%"),
        ("explained by the map", "-" if explained is None else f"{100 * explained:.0f}", "%"),
        ("path", f"{metrics['path_m']:.1f}", "m"),
        ("time", f"{result.seconds.sum():.2f}", "s"),
    ]
