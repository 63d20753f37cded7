"""`tagalong slam`: maps a recorded drive."""

import argparse
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...perception.compiled_parts import track_people
from ...perception.immobile.slam import ImmobileSlam
from ...slam.engine import ENGINES, SlamEngine, make_slam
from ...slam.errors import InputError
from ...slam.first_use.compiling import Part, compiled_together
from ...slam.first_use.parts import correct_drive, map_by_graph, map_by_particles
from ...slam.logs.drive import RecordedDrive
from ...slam.logs.tum import read_tum
from ...slam.runner import run_slam
from ..console.arguments import random_seed, within
from ..console.log_options import add_odometry, add_topics, read_with_odometry
from ..console.record_option import add_record, check_record
from ..console.setting_words import add_settings, read_settings
from ..console.tables import format_table
from ..runs.immobile_slam import IMMOBILE, OWN, add_mapping_options, check_mapping, immobile_slam, write_layers
from ..runs.people_removal import add_people_options, people_filter_config, remove_people
from ..runs.slam_recording import record_run
from ..runs.slam_run import prepare_folder, progress_bar, write_run

_PARTS: dict[str, Part] = {"cartographer": map_by_graph, "gmapping": map_by_particles}
"""What takes long to compile of the engines, by `--method`."""
EPILOG = """\
writes into DIR:
  trajectory.tum         one pose a scan: t x y z qx qy qz qw
                         (t: the number of the scan where the log has no usable times)
  map.pgm, map.yaml      the map, as ROS map_server reads it
  map.png                the map with the trajectory, to look at
  landmarks.json         with --method ekf: the landmarks, for tagalong localize --method landmarks
  metrics.json           configuration and results; how often it was not sure where it is,
                         and at how many scans it did not believe the odometry; what graph SLAM
                         learned of the wheels (true way and turn by the odometry's, rad/m);
                         errors where the log has reference poses
                         (its own corrected poses, or NAME.gt.tum beside NAME.log.gz)
  timing.json            speed and memory; the only file that differs between two runs
  movable.pgm, .yaml     with --mapping immobile: things that stood and left, such as doors
  people.json            with --filter-people: who was tracked and where, in the odometry frame;
                         metrics.json says how many returns were removed

Odometry that says less than 0.8 or more than 1.25 metres or radians for each one that the scans show, and a laser that
stands elsewhere on the robot than the log says, are put right, and said in a line on stderr.

example:
  tagalong slam aces.log.gz --out out/aces
  tagalong slam aces.log.gz --out out/gmapping --method gmapping --seed 1 --set particles=50
  tagalong slam drive.bag --out out/drive --scan-topic /front/scan
  tagalong slam drive.log --out out/drive --odometry refined --matcher icp
  tagalong slam drive.bag --out out/drive --filter-people
  tagalong slam drive.bag --out out/drive --record out/drive.mcap
  tagalong slam lab.mcap --out out/lab --mapping immobile --method immobile --forest simulation
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.epilog = EPILOG
    parser.add_argument(
        "log",
        type=Path,
        metavar="LOG",
        help="CARMEN, BeeSoft, DP-SLAM or tinySLAM log (plain or .gz), ROS 1 bag or ROS 2 bag folder",
    )
    add_topics(parser)
    add_odometry(parser)
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="where the results go")
    parser.add_argument(
        "--method", default="cartographer", help=f"SLAM engine: {', '.join(ENGINES)}, immobile (default: %(default)s)"
    )
    parser.add_argument("--seed", type=random_seed, default=0, help="seed of all random draws (default: %(default)s)")
    parser.add_argument(
        "--resolution", type=within(0.001, 10.0), metavar="M", help="side of a map cell [m] (default: the engine's)"
    )
    add_settings(parser, "a field of the engine's configuration, e.g. particles=50 or local.insertion_voxel=0.1")
    add_people_options(parser)
    add_mapping_options(parser)
    add_record(parser)
    parser.add_argument("--quiet", action="store_true", help="no progress bar")


def run(options: argparse.Namespace) -> int:
    """Map the log, write the results, print a table."""
    parts: list[Part] = [track_people] if options.filter_people else []
    parts += [part for method, part in _PARTS.items() if method == options.method]
    with compiled_together(*parts, correct_drive):
        return _map_log(options)


def _map_log(options: argparse.Namespace) -> int:
    check_record(options.record)
    check_mapping(options)
    forest = options.forest if options.mapping == OWN else None
    people = people_filter_config(options.filter_people, forest)
    engine = _engine(options)
    read = read_with_odometry(options)
    drive = read.drive
    reference = _reference(options.log, drive)
    prepare_folder(options.out)
    if options.mapping == IMMOBILE:
        engine = immobile_slam(options, drive, engine)
    assert engine is not None
    how: dict[str, Any] = {"method": options.method, "seed": options.seed, "config": asdict(engine.config)}
    how |= {"mapping": options.mapping} if options.mapping != OWN else {}
    how |= read.settings
    if people is not None:
        drive, how["people_filter"] = remove_people(drive, people, options.out, not options.quiet)
    result = run_slam(engine, drive, progress=progress_bar(drive.name, not options.quiet))
    if isinstance(engine, ImmobileSlam):
        how |= write_layers(options.out, engine)
    metrics = write_run(options.out, drive, result, how, reference, options.resolution)
    if options.record is not None:
        tracked = options.out / "people.json" if people is not None else None
        record_run(options.record, drive, result, result.map(options.resolution), tracked)
    print(format_table(("quantity", "value", "unit"), _rows(metrics, float(result.seconds.sum()))))
    print(f"written to {options.out}")
    return 0


def _engine(options: argparse.Namespace) -> SlamEngine | None:
    """Return the engine that localizes; None: the immobile-area map itself does."""
    settings = read_settings(options.settings)
    if options.method != IMMOBILE:
        return make_slam(options.method, seed=options.seed, **settings)
    if settings:
        raise InputError("--set is of an engine's configuration; --method immobile has none")
    return None


def _reference(log: Path, drive: RecordedDrive) -> NDArray[np.float64] | None:
    """Return the poses (n, 3) to compare with: true poses beside the log, or the log's own corrected ones."""
    truth = log.parent / f"{log.name.removesuffix('.gz').removesuffix('.log')}.gt.tum"
    if not truth.exists():
        return drive.reference
    poses = read_tum(truth).poses
    if len(poses) != len(drive):
        raise InputError(f"{truth}: one pose a scan needed, got {len(poses)} for {len(drive)}")
    return poses


def _learned(factors: dict[str, float] | None) -> list[tuple[str, str, str]]:
    if factors is None:
        return []
    return [
        ("way, of what odometry tells", f"{factors['way']:.3f}", ""),
        ("turn, of what it tells", f"{factors['turn']:.3f}", ""),
        ("turn that it does not tell", f"{factors['turn_per_metre']:+.3f}", "rad/m"),
        ("odometry comes late by", f"{factors['late_s']:+.2f}", "s"),
    ]


def _known_to(sigma: dict[str, float] | None) -> list[tuple[str, str, str]]:
    return [] if sigma is None else [("standard deviation, median", f"{sigma['median']:.2f}", "m")]


def _rows(metrics: dict[str, Any], wall_s: float) -> list[tuple[str, str, str]]:
    rows = [
        ("scans", str(metrics["scans"]), ""),
        ("integrated", str(metrics["integrated_scans"]), ""),
        ("not sure where it is", str(metrics["not_sure"]["scans"]), "scans"),
        *_known_to(metrics["standard_deviation_m"]),
        ("odometry not believed", str(metrics["odometry_not_believed"]["scans"]), "scans"),
        *_learned(metrics["odometry_factors"]),
        *([("camera's views", str(metrics["views"]), "")] if "views" in metrics else []),
        ("path", f"{metrics['path_m']:.1f}", "m"),
        ("free area", f"{metrics['map']['free_m2']:.1f}", "m2"),
        ("engine time", f"{wall_s:.2f}", "s"),
    ]
    if "people_filter" in metrics:
        removed = metrics["people_filter"]
        rows.append(("people", str(removed["people"]), ""))
        rows.append(
            ("removed", f"{100.0 * removed['removed_returns'] / max(removed['returns'], 1):.2f}", "% of returns")
        )
    errors = metrics["against_reference"]
    if errors is not None:
        rows += [
            ("ATE rmse", f"{100 * errors['ate_m']['rmse']:.2f}", "cm"),
            ("ATE max", f"{100 * errors['ate_m']['max']:.2f}", "cm"),
            ("heading error mean", f"{errors['ate_deg']['mean']:.2f}", "deg"),
        ]
    return rows
