"""A robot that wakes up somewhere on a finished map, or is carried away: how soon it knows where it is.

The maps are our own: of people-free drives through the simulated scenes, and of every second scan of the Intel log.
`half`: of a part of a recorded drive, mapped while the robot is carried anywhere on the drive; found and wrong count to
0.5 m and 10 degrees there, apart for those who end on that map and those who end off it.

The seed says which building a scene is, and where robots are carried to.

example:
  tagalong bench kidnapping data/slam_logs --trials 100 --jobs 2
"""

import argparse
import copy
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ...envs.recording.slow_tour import slow_tour
from ...envs.world.world import WorldConfig
from ...slam.engine import make_slam
from ...slam.errors import InputError
from ...slam.grid import GridConfig, render_map
from ...slam.localization.localizer import Localizer
from ...slam.localization.runner import run_localizer
from ...slam.logs.carmen import read_carmen
from ...slam.logs.drive import RecordedDrive
from ...slam.occupancy_map import OccupancyMap
from ...slam.quality.trajectory import absolute_error
from ...slam.runner import SlamRun, run_slam
from ..console.arguments import at_least, random_seed
from ..console.tables import format_table
from ..lab.cells import TIMING, Cell, run_cells
from ..lab.scan_pairs import LOGS
from ..lab.statistics import share
from .half_mapped import DRIVES, LEG_SCANS, carried_off_a_half_map, judge
from .kidnapped_legs import Leg, LegSource, RecordedLegs, SimulatedLegs
from .results import write_results

SCENES = ("corridor", "meeting_room")
PEOPLE = 2
BLOCK = 10  # trials of one cell
SLAM_BLOCK = 50  # likewise, where a cell maps the whole drive first
SCANS = 10  # in which the robot must be found
BEFORE = 6  # scans of a tracked robot before it is carried away
LINEAR, ANGULAR = 0.3, np.radians(5.0)
_RESOLUTION = 0.05


def map_scene(scene: str, seed: int, files: Path) -> dict[str, Any]:
    """Map a scene by a slow drive without people; keep the map and where it lies in the world."""
    drive = slow_tour(WorldConfig(scene=scene), seed)
    mapped = _mapped(drive.recording)
    placed = absolute_error(mapped.trajectory, drive.truth)
    _keep(files, mapped.map(_RESOLUTION), T_world_map=placed.T_ref_est)
    return {"scans": len(drive.recording), "ate_m": placed.translation.rmse}


def map_log(folder: str, building: str, files: Path) -> dict[str, Any]:
    """Map every second scan of a log at the poses that SLAM of all scans found; keep the map and the poses."""
    drive = read_carmen(Path(folder) / LOGS[building])
    poses = _mapped(drive).trajectory
    _keep(files, render_map(poses[::2], drive.scans[::2], GridConfig(resolution=_RESOLUTION)), truth=poses)
    return {"scans": len(drive)}


def awake(
    building: str,
    folder: str | None,
    people: int,
    carried: bool,
    seed: int,
    first: int,
    trials: int,
    inputs: Sequence[Path],
) -> dict[str, Any]:
    """Return what became of some trials: by which scan the robot was found, its errors, and whether it was wrong.

    Args:
        building: Scene, or name of a log.
        folder: Of the logs; None: a scene.
        people: Who walk in a scene while the robot looks for itself.
        carried: Whether it was tracked elsewhere before, and not told.
        seed: Of the scene, and of all trials.
        first: Number of the first trial; each has random numbers of its own.
        trials: How many.
        inputs: Folder of the map.
    """
    kept = np.load(inputs[0] / "map.npz")
    grid = OccupancyMap(kept["probability"], float(kept["resolution"]), tuple(kept["origin"].tolist()))
    result: dict[str, Any] = {"found_at": [], "error_m": [], "error_deg": [], "wrong": []}
    legs, times = _legs(building, folder, people, seed, grid, kept), list[float]()
    for trial in range(first, first + trials):
        rng = np.random.default_rng([seed, trial, carried, people])
        outcome = _trial(legs, grid, carried, rng, times)
        for key, value in outcome.items():
            result[key].append(value)
    return {**result, TIMING: {"median_ms": 1e3 * np.median(times), "longest_ms": 1e3 * max(times)}}


def carried_while_mapping(
    building: str, folder: str | None, people: int, seed: int, first: int, trials: int, inputs: Sequence[Path]
) -> dict[str, Any]:
    """Return what became of trials in which SLAM has mapped the whole drive when the robot is carried away.

    A pose counts only where SLAM says that it is located. Arguments as of `awake`; of a log, the legs are of scans
    that were mapped, too.
    """
    kept = np.load(inputs[0] / "map.npz")
    grid = OccupancyMap(kept["probability"], float(kept["resolution"]), tuple(kept["origin"].tolist()))
    if folder is None:
        drive = slow_tour(WorldConfig(scene=building), seed).recording
        legs = _legs(building, None, people, seed, grid, kept)
    else:
        drive = read_carmen(Path(folder) / LOGS[building])
        legs = RecordedLegs(drive, kept["truth"], np.ones(len(drive), dtype=np.bool_))
    engine = _mapped(drive).engine  # its graph is adjusted now, not in each trial
    result: dict[str, Any] = {"found_at": [], "error_m": [], "error_deg": [], "wrong": []}
    last = Leg(drive.odometry[-1:], drive.scans[-1:], drive.odometry[-1:])
    for trial in range(first, first + trials):
        rng = np.random.default_rng([seed, trial, 2, people])
        kept_scans = {id(scan): scan for scan in drive.scans}  # they never change: no copy of them is needed
        robot, leg = copy.deepcopy(engine, kept_scans), legs.draw(SCANS, rng).after(last)
        updates = [robot.update(odometry, scan) for odometry, scan in zip(leg.odometry, leg.scans, strict=True)]
        judged = judge([u.pose if u.located else None for u in updates], leg.truth, LINEAR, ANGULAR)
        for key, value in judged.items():
            result[key].append(value)
    return result


def cells(folder: Path | None, trials: int, seed: int) -> list[Cell]:
    """Return all cells: the maps, and blocks of trials; without a folder of logs only those of the scenes."""
    made = [
        Cell(name=f"map/{scene}", function=map_scene, arguments={"scene": scene, "seed": seed}, keeps_files=True)
        for scene in SCENES
    ]
    settings: list[tuple[str, str | None, int]] = [(scene, None, people) for scene in SCENES for people in (0, PEOPLE)]
    if folder is not None:
        source = {"folder": str(folder), "building": "intel"}
        made.append(Cell(name="map/intel", function=map_log, arguments=source, keeps_files=True))
        settings.append(("intel", str(folder), 0))
    for building, logs, people in settings:
        for carried in (False, True):
            for first in range(0, trials, BLOCK):
                arguments = {
                    "building": building, "folder": logs, "people": people, "carried": carried,
                    "seed": seed, "first": first, "trials": min(BLOCK, trials - first),
                }  # fmt: skip
                name = f"{building}/{people}p/{'carried' if carried else 'awake'}/{first}"
                made.append(Cell(name=name, function=awake, arguments=arguments, needs=(f"map/{building}",)))
        for first in range(0, trials, SLAM_BLOCK):
            arguments = {
                "building": building, "folder": logs, "people": people, "seed": seed,
                "first": first, "trials": min(SLAM_BLOCK, trials - first),
            }  # fmt: skip
            name = f"{building}/{people}p/slam/{first}"
            made.append(
                Cell(name=name, function=carried_while_mapping, arguments=arguments, needs=(f"map/{building}",))
            )
    for drive in DRIVES if folder is not None else ():
        for first in range(0, trials, SLAM_BLOCK):
            arguments = {
                "folder": str(folder), "drive": drive, "seed": seed,
                "first": first, "trials": min(SLAM_BLOCK, trials - first),
            }  # fmt: skip
            made.append(Cell(name=f"{drive}/half/{first}", function=carried_off_a_half_map, arguments=arguments))
    return made


def summary(results: Mapping[str, Mapping[str, Any]]) -> dict[str, dict[str, Any]]:
    """Return by building, people and kind: the shares found, and wrong though sure, after all scans; when; errors.

    Robots that were carried off a half map are told apart by whether they ended on it.
    """
    joined: dict[str, dict[str, list[Any]]] = {}
    for name, result in results.items():
        if name.startswith("map/"):
            continue
        for k in range(len(result["wrong"])):
            end = ("/on" if result["on_map"][k] else "/off") if "on_map" in result else ""
            together = joined.setdefault(name.rsplit("/", 1)[0] + end, {})
            for key in ("found_at", "error_m", "error_deg", "wrong"):
                together.setdefault(key, []).append(result[key][k])
    table = {}
    for name, together in joined.items():
        found = [value is not None for value in together["found_at"]]
        scans = [value for value in together["found_at"] if value is not None]
        table[name] = {
            "found": share(found).to_dict(),
            "wrong": share(together["wrong"]).to_dict(),
            "median_scans": float(np.median(scans)) if scans else None,
            "p95_scans": float(np.quantile(scans, 0.95)) if scans else None,
            "median_error_cm": 100.0 * float(np.median([v for v in together["error_m"] if v is not None] or [np.nan])),
        }
    return table


def _trial(
    legs: LegSource, grid: OccupancyMap, carried: bool, rng: np.random.Generator, times: list[float]
) -> dict[str, Any]:
    localizer = Localizer(grid)
    leg = legs.draw(SCANS, rng)
    if carried:
        before = legs.draw(BEFORE, rng)
        localizer = Localizer(grid, start=before.truth[0])
        run_localizer(localizer, RecordedDrive(before.odometry, before.scans, None, "before"))
        leg = leg.after(before)
    run = run_localizer(localizer, RecordedDrive(leg.odometry, leg.scans, None, "after"))
    times.extend(run.seconds.tolist())
    poses = [pose if sure else None for pose, sure in zip(run.trajectory, run.sure, strict=True)]
    return judge(poses, leg.truth, LINEAR, ANGULAR)


def _mapped(drive: RecordedDrive) -> SlamRun:
    return run_slam(make_slam("cartographer"), drive)


def _legs(
    building: str, folder: str | None, people: int, seed: int, grid: OccupancyMap, kept: Mapping[str, Any]
) -> LegSource:
    if folder is None:
        return SimulatedLegs(building, seed, people, grid, kept["T_world_map"])
    truth = kept["truth"]
    return RecordedLegs(read_carmen(Path(folder) / LOGS[building]), truth, np.arange(len(truth)) % 2 == 1)


def _keep(files: Path, grid: OccupancyMap, **more: Any) -> None:
    np.savez(files / "map.npz", probability=grid.probability, resolution=grid.resolution, origin=grid.origin, **more)


def _interval(row: Mapping[str, float]) -> str:
    return f"{row['mean']:.2f} [{row['low']:.2f}, {row['high']:.2f}]"


def _scans(number: float | None) -> str:
    return "" if number is None else f"{number:.1f}"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("logs", type=Path, metavar="LOGS", help="folder of recorded logs")
    parser.add_argument("--trials", type=at_least(1), default=100, help="of each building (default: %(default)s)")
    parser.add_argument("--jobs", type=at_least(1), default=1, help="processes (default: %(default)s)")
    parser.add_argument("--seed", type=random_seed, default=0, help="of scenes and places (default: %(default)s)")


def run(options: argparse.Namespace) -> int:
    """Measure, print, write results.json."""
    if not options.logs.is_dir():
        raise InputError(f"{options.logs} is not a folder")
    results = run_cells(cells(options.logs, options.trials, options.seed), options.out, jobs=options.jobs)
    table = summary(results)
    write_results(options, {"results": table})
    rows = [
        (
            name,
            _interval(row["found"]),
            _interval(row["wrong"]),
            _scans(row["median_scans"]),
            _scans(row["p95_scans"]),
            f"{row['median_error_cm']:.1f}",
        )
        for name, row in table.items()
    ]
    found = f"found in {SCANS} scans (half: {LEG_SCANS})"
    header = ("building", found, "sure but wrong", "median scans", "p95 scans", "median error [cm]")
    print(format_table(header, rows))
    return 0
