"""SLAM beside walking people: each engine on raw scans, on ours without people, and on truly people-free ones.

Drives are simulated (a robot behind its leader, further people about) by scene and seed, or read from --logs, a folder
of NAME.log.gz with NAME.gt.tum and NAME.people.npz. Simulated ones are written to OUT/logs in that form and, with the
extra `ros`, as ROS 1 bags, so that others can run their engines on them. Their trajectories enter by --others, a folder
with NAME/ENGINE.tum or NAME/ENGINE.tum.gz, one pose a scan. All maps are drawn alike, from scans and trajectory.

`ATE`: absolute trajectory error, root mean square and largest [cm]. `relation`: mean errors of relations 10 s apart
[cm, deg]. `ghosts`: occupied cells (5 cm) that are free in truth and that people crossed. `missing`: mean distance from
a true wall to the nearest on the map [cm]; `false`: the other way round.

example:
  tagalong bench slam-among-people --scenes corridor --seeds 0 1 --people 2
  tagalong bench slam-among-people --logs reference --names corridor-1p-s0 --others reference/rivals
"""

import argparse
import time
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ...agents.tour import TourConfig, following_tour
from ...envs.onboard.config import PERCEPTION
from ...perception.config import PRESETS, perception_preset
from ...slam.engine import ENGINES, make_slam
from ...slam.errors import InputError, MissingExtraError, unknown_name
from ...slam.files.output import write_text
from ...slam.logs.bag_writer import write_rosbag
from ...slam.logs.drive_folder import SimulatedDrive, read_drive, write_drive
from ...slam.logs.tum import read_tum
from ...slam.runner import run_slam
from ..console.arguments import at_least, random_seed
from ..console.tables import format_table
from ..lab.maps_among_people import FILTERS, DriveAmongPeople, without_reference
from .results import write_results

FIGURES = ("ate_cm", "ate_max_cm", "relation_cm", "relation_deg", "ghost_cells", "missing_cm", "false_cm")
HEADER = ("drive", "engine", "scans", "ATE", "max", "relation", "deg", "ghosts", "missing", "false")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("--scenes", nargs="+", default=["corridor", "meeting_room"], metavar="NAME")
    parser.add_argument("--seeds", nargs="+", type=random_seed, default=[0, 1, 2], metavar="SEED")
    parser.add_argument("--people", type=at_least(1), default=2, help="who walk, the leader counted (default: 2)")
    parser.add_argument("--odometry", default="typical", help="of simulated drives (default: %(default)s)")
    parser.add_argument("--logs", type=Path, metavar="DIR", help="drives to read instead")
    parser.add_argument("--names", nargs="+", metavar="NAME", help="which of them (default: all with people)")
    parser.add_argument("--others", type=Path, metavar="DIR", help="trajectories of other engines, NAME/ENGINE.tum")
    parser.add_argument("--engines", nargs="*", default=["gmapping", "cartographer"], help="ours (default: both)")
    parser.add_argument("--filters", nargs="+", choices=FILTERS, default=list(FILTERS), help="(default: all)")
    parser.add_argument("--preset", default="recorded", choices=list(PRESETS), help="of our filter (default: recorded)")
    parser.add_argument("--forest", default="simulation", help="of our filter (default: simulation)")


def run(options: argparse.Namespace) -> int:
    """Measure, print, write results.json and report.md."""
    for name in options.engines:
        if name not in ENGINES:
            raise unknown_name("SLAM engine", name, tuple(ENGINES))
    config = replace(perception_preset(options.preset), forest=options.forest, detector=PERCEPTION.detector)
    rows = []
    for drive in drives(options):
        for row in judged(DriveAmongPeople(without_reference(drive), config), options):
            rows.append(row)
            print("  ".join(shown(row)), flush=True)
    table = format_table(HEADER, [shown(row) for row in rows])
    means = format_table(HEADER, [shown(row) for row in averages(rows)])
    write_text(options.out / "report.md", report(table, means))
    write_results(options, {"drives": rows, "means": averages(rows)})
    print(means)
    return 0


def drives(options: argparse.Namespace) -> Iterator[SimulatedDrive]:
    """Yield the drives to be mapped, with truth; simulated ones are written to OUT/logs.

    Raises:
        InputError: If there are none.
    """
    if options.logs is not None:
        names = options.names or sorted(path.name.removesuffix(".people.npz") for path in _with_people(options.logs))
        if not names:
            raise InputError(f"no drives with people (NAME.people.npz) in {options.logs}")
        for name in names:
            yield read_drive(options.logs, name)
        return
    for scene in options.scenes:
        for seed in options.seeds:
            tour = TourConfig(scene=scene, people=options.people, odometry=options.odometry, seed=seed)
            drive = following_tour(tour).drive
            write_drive(options.out / "logs", drive)
            with suppress(MissingExtraError):
                write_rosbag(options.out / "logs" / f"{drive.recording.name}.bag", drive.recording)
            yield drive


def _with_people(folder: Path) -> list[Path]:
    found = []
    for path in folder.glob("*.people.npz"):
        with np.load(path, allow_pickle=False) as content:
            found += [path] if content["feet"].size else []
    return found


def judged(job: DriveAmongPeople, options: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """Yield a row for each engine and filter, and for each trajectory of others, whose map is drawn of raw scans."""
    recording = job.drive.recording
    for engine in options.engines:
        for name in options.filters:
            scans = job.scans[name]
            start = time.process_time()
            trajectory = run_slam(make_slam(engine, seed=0), replace(recording, scans=scans)).trajectory
            spent = time.process_time() - start
            row = {"drive": recording.name, "engine": engine, "scans": name, **job.judge(trajectory, scans)}
            yield row | {"seconds": spent}
    folder = options.others / recording.name if options.others is not None else None
    for path in sorted(folder.glob("*.tum*")) if folder is not None and folder.is_dir() else ():
        try:
            figures = job.judge(read_tum(path).poses, recording.scans)
        except InputError as error:
            raise InputError(f"{path}: {error}") from error
        yield {"drive": recording.name, "engine": f"others/{path.name.split('.tum')[0]}", "scans": "raw", **figures}


def averages(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return a row for each engine and filter, with means over the drives."""
    kinds = dict.fromkeys((row["engine"], row["scans"]) for row in rows)
    out = []
    for engine, scans in kinds:
        same = [row for row in rows if (row["engine"], row["scans"]) == (engine, scans)]
        means = {name: float(np.mean([row[name] for row in same])) for name in FIGURES}
        out.append({"drive": f"mean of {len(same)}", "engine": engine, "scans": scans, **means})
    return out


def shown(row: dict[str, Any]) -> list[str]:
    """Return the words of a row of the table."""
    return [row["drive"], row["engine"], row["scans"], *(f"{row[name]:.2f}" for name in FIGURES)]


def report(table: str, means: str) -> str:
    """Return the report, with the day on which it was made."""
    about = (__doc__ or "").split("example:")[0].rstrip()
    return f"# SLAM among people, {time.strftime('%Y-%m-%d')}\n\n{about}\n\n```\n{means}\n\n{table}\n```\n"
