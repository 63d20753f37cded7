"""SLAM on drives that something is wrong with: faults of odometry, clock and laser in logs and drawn worlds.

Each cell is a drive, a fault and an engine; finished cells are not run again. The error is the mean relation error
where relations are known, else the ATE. Told is whether an engine that is more than 1 m off for 50 scans says in one of
them that it is not located.

The report judges graph SLAM by GMapping in the same cell, by the same drive without a fault, and by itself without
recovery.

example:
  tagalong bench slam-faults data --logs aces csail --worlds 5 --jobs 2
"""

import argparse
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from ...slam.drives.calibration import calibrated
from ...slam.engine import SlamEngine, make_slam
from ...slam.errors import InputError
from ...slam.logs.drive import RecordedDrive
from ...slam.logs.faults import FAULTS
from ...slam.runner import run_slam
from ..console.arguments import at_least
from ..figures.plots import require_matplotlib
from ..lab.cells import TIMING, Cell, run_cells
from ..lab.memory import memory_mb
from ..lab.trend import give_back_memory
from .fault_drives import LOGS, fault_drive, related_truth, world_names
from .fault_report import write_report
from .fault_scores import honesty
from .fault_verdicts import faulty_cells, verdicts
from .results import write_results

ENGINES: dict[str, dict[str, Any]] = {
    "gmapping": {"name": "gmapping", "seed": 0},
    "cartographer": {"name": "cartographer"},
    "cartographer without recovery": {"name": "cartographer", "recovery": False},
}
"""Name -> what `make_slam` is asked for."""
QUICK_LOGS = ("aces", "belgioioso")
QUICK_FAULTS = ("none", "frozen-5", "every-4", "dropped-beams", "stuck-beams")
QUICK_WORLDS = 2
_WARM_UP = 400  # scans of a drawn world, so that nothing is compiled or loaded while others are timed


def faulty(folder: str | None, drive: str, fault: str, engine: str, inputs: Sequence[Path] = ()) -> dict[str, Any]:
    """Return what an engine makes of a drive with a fault: its errors, its opinion of itself, time and memory.

    Args:
        folder: Of the logs.
        drive: Name as of `fault_drive`.
        fault: Name in `FAULTS`.
        engine: Name in `ENGINES`.
        inputs: Folder of the truth of a log that has relations only; none otherwise.
    """
    whole = fault_drive(folder, drive)
    rng = np.random.default_rng([*f"{drive}/{fault}".encode()])
    disturbed = FAULTS[fault].into(whole.recording, rng)
    recording, origin = calibrated(_fresh(disturbed.recording)), disturbed.origin
    result: dict[str, Any] = {"scans": len(recording), "measure": "ATE" if whole.relations is None else "relations"}
    _warm_up(engine)
    give_back_memory()
    robot, before, start = make_engine(engine), memory_mb(), time.process_time()
    try:
        run = run_slam(robot, recording, clock=time.process_time)
    except Exception as error:  # whatever an engine ends with is a finding, and the other cells go on
        return {**result, "failed": f"{type(error).__name__}: {error}"[:300]}
    took = time.process_time() - start
    if whole.relations is None:
        assert whole.recording.reference is not None
        truth = whole.recording.reference
    else:
        truth = np.load(inputs[0] / "truth.npy")
    result |= {"error": whole.error(run.trajectory, origin), "online": whole.error(run.online, origin)}
    result |= honesty(run.online, run.located, truth[origin]).to_dict()
    result |= {name: getattr(robot, name) for name in ("losses", "relocalizations", "rejected") if hasattr(robot, name)}
    timing = {"processor_s": took, "p99_ms": 1e3 * float(np.quantile(run.seconds, 0.99))}
    return {**result, TIMING: {**timing, "memory_mb": memory_mb() - before}}


def truth_of(folder: str, drive: str, files: Path) -> dict[str, Any]:
    """Find where the robot was in a log that has relations only, by GMapping's path and the relations; keep it."""
    whole = fault_drive(folder, drive)
    run = run_slam(make_engine("gmapping"), _fresh(whole.recording))
    truth, origin = related_truth(whole, run.trajectory), np.arange(len(run.trajectory))
    np.save(files / "truth.npy", truth)
    return {"gmapping": whole.error(run.trajectory, origin), "truth": whole.error(truth, origin)}


def make_engine(name: str) -> SlamEngine:
    """Return a new engine of `ENGINES`."""
    return make_slam(**ENGINES[name])


def cells(folder: Path | None, drives: Sequence[str], faults: Sequence[str], engines: Sequence[str]) -> list[Cell]:
    """Return every cell; a fault that is measured needs the drive without one beside it."""
    logs = None if folder is None else str(folder)
    made = [
        Cell(name=f"truth/{drive}", function=truth_of, arguments={"folder": logs, "drive": drive}, keeps_files=True)
        for drive in drives
        if has_relations(drive)
    ]
    for drive in drives:
        for fault in dict.fromkeys(("none", *faults)):
            for engine in engines:
                source = logs if drive in LOGS else None
                arguments = {"folder": source, "drive": drive, "fault": fault, "engine": engine}
                needs = (f"truth/{drive}",) if has_relations(drive) else ()
                made.append(Cell(name=f"{drive}/{fault}/{engine}", function=faulty, arguments=arguments, needs=needs))
    return made


def has_relations(drive: str) -> bool:
    """Return whether a drive is a log whose errors are told by relations."""
    return drive in LOGS and LOGS[drive].relations is not None


def _fresh(drive: RecordedDrive) -> RecordedDrive:
    """Return the drive with scans that have not computed their points yet."""
    return replace(drive, scans=[replace(scan) for scan in drive.scans])


@lru_cache
def _warm_up(engine: str) -> None:
    recording = fault_drive(None, world_names(1)[0]).recording
    part = replace(recording, odometry=recording.odometry[:_WARM_UP], scans=recording.scans[:_WARM_UP], reference=None)
    run_slam(make_engine(engine), part)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("data", type=Path, nargs="?", metavar="DATA", help="holds the folder slam_logs (default: none)")
    parser.add_argument("--logs", nargs="*", choices=LOGS, metavar="LOG", help=f"of {', '.join(LOGS)} (default: all)")
    parser.add_argument("--worlds", type=at_least(0), default=10, help="drawn worlds (default: %(default)s)")
    parser.add_argument("--faults", nargs="+", choices=FAULTS, metavar="FAULT", help=f"of {', '.join(FAULTS)}")
    parser.add_argument("--engines", nargs="+", choices=ENGINES, default=list(ENGINES), help="(default: all)")
    parser.add_argument("--quick", action="store_true", help="a handful of drives and faults")
    parser.add_argument("--jobs", type=at_least(1), default=1, help="processes (default: 1)")


def run(options: argparse.Namespace) -> int:
    """Measure, print, write results.json and report.html; return 1 where a verdict fails."""
    require_matplotlib()
    wanted = _wanted(options)
    results: Mapping[str, Any] = run_cells(wanted, options.out, jobs=options.jobs)
    rows = faulty_cells(results)
    judged = verdicts(rows)
    write_results(options, {"verdicts": [verdict.to_dict() for verdict in judged], "results": results})
    truths = {name.split("/")[1]: result for name, result in results.items() if name.startswith("truth/")}
    print(write_report(options.out, rows, judged, truths))
    return int(not all(verdict.holds for verdict in judged))


def _wanted(options: argparse.Namespace) -> list[Cell]:
    """Return the cells that the options ask for."""
    folder = None if options.data is None else options.data / "slam_logs"
    if folder is None and options.logs:
        raise InputError("--logs needs the folder DATA, which holds slam_logs")
    if folder is not None and not folder.is_dir():
        raise InputError(f"{folder} is not a folder")
    logs = options.logs if options.logs is not None else list(QUICK_LOGS if options.quick else LOGS)
    worlds = world_names(min(options.worlds, QUICK_WORLDS) if options.quick else options.worlds)
    faults = options.faults or list(QUICK_FAULTS if options.quick else FAULTS)
    wanted = cells(folder, [*(logs if folder else ()), *worlds], faults, options.engines)
    if not wanted:
        raise InputError("nothing to measure: neither a log nor a drawn world")
    return wanted
