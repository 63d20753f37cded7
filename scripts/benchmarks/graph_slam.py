"""What graph SLAM with its defaults makes of recorded and simulated logs, beside the original engines.

One configuration for all logs. Times are processor time, beside that of a fixed numpy kernel in the same process.

DATA holds the folder slam_logs, REFERENCE simulated logs NAME.log.gz with true poses NAME.gt.tum and the same drives
without the returns on true feet, NAME-filtered.log.gz.

example:
  tagalong bench graph-slam data simulated-logs --jobs 2
"""

import argparse
import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...perception.hindsight import filtered_scans
from ...perception.people_filter import PeopleFilterConfig
from ...slam.errors import InputError
from ...slam.geometry import between, compose, inverse
from ...slam.graph.engine import Cartographer
from ...slam.graph.loops.constraints import Kind
from ...slam.logs.carmen import read_carmen
from ...slam.logs.drive import RecordedDrive
from ...slam.logs.relations import read_readings, read_relations
from ...slam.logs.tum import Trajectory, read_tum
from ...slam.quality.relations import score_relations
from ...slam.quality.trajectory import absolute_error
from ..console.arguments import at_least
from ..console.tables import format_table
from ..lab.cells import TIMING, Cell, run_cells
from ..lab.hardware import reference_kernel_s
from ..runs.slam_run import usable_times
from .acceptance import LOGS
from .intel_reference import READINGS, RELATIONS, corrected_poses, published_poses, related_poses
from .results import write_results
from .speed import thinned

Array = NDArray[np.float64]

WITHIN = (0.2, np.radians(1.0))  # [m, rad] of a right loop closure
APART = 120  # nodes between a submap's first and a node that comes back to it
SPEED_REPEATS = 3
SPEED_BEAMS = 360


@dataclass(frozen=True, kw_only=True)
class Simulated:
    """A simulated log and the best pose error among the original engines.

    Attributes:
        log: Name of its file.
        truth: Name of the file of true poses.
        tracked: Whether our own tracker filters people out of the raw scans.
        rival_cm: ATE rmse of the best original engine on this log [cm]; None: nobody ran on it.
    """

    log: str
    truth: str
    tracked: bool = False
    rival_cm: float | None = None


SIMULATED = {"rooms-d": Simulated(log="rooms-d", truth="rooms-d", rival_cm=0.57)}
for _name, _free, _raw, _filtered in (
    ("corridor-{}p-s0", 1.0, (1, 1.1), 0.9),
    ("meeting-{}p-s0", 0.4, (2, 0.5), 0.35),
    ("plainslip-{}p-s0", None, (2, 2.0), 2.1),
):
    _empty, _busy = _name.format(0), _name.format(_raw[0])
    SIMULATED[_empty] = Simulated(log=_empty, truth=_empty, rival_cm=_free)
    SIMULATED[f"{_busy} raw"] = Simulated(log=_busy, truth=_busy, rival_cm=_raw[1])
    SIMULATED[f"{_busy} true filter"] = Simulated(log=f"{_busy}-filtered", truth=_busy, rival_cm=_filtered)
    SIMULATED[f"{_busy} own tracker"] = Simulated(log=_busy, truth=_busy, tracked=True, rival_cm=_filtered)
LOG_RIVALS = {"intel": "0.038 m, 1.10 deg (LaMa)", "aces": "0.095 m (LaMa)", "belgioioso": "0.122 m (GMapping)"}
TARGETS = {"intel": "<= 0.030 m, 1.1 deg", "aces": "< 0.095 m", "belgioioso": "<= 0.12 m"}


def recorded(folder: str, log: str) -> dict[str, Any]:
    """Return the errors on a recorded log, of the final and the online poses, and how its loops were closed."""
    logs = Path(folder) / "slam_logs"
    drive = read_carmen(logs / LOGS[log])
    engine, timing = _driven(drive)
    result = {**_counts(engine), TIMING: timing}
    for name, poses in (("final", engine.trajectory()), ("online", engine.online_trajectory())):
        if drive.reference is not None:
            result[name] = {"ate_m": absolute_error(poses, drive.reference).translation.rmse}
        else:
            relations, readings = read_relations(logs / RELATIONS), read_readings(logs / READINGS)
            error = score_relations(Trajectory(usable_times(drive), poses), relations, readings)
            result[name] = {"relation_m": error.translation.mean, "relation_deg": error.rotation.mean}
    if drive.reference is not None:
        return {**result, "closures": closures(engine, drive.reference)}
    open_loops, _ = _driven(_fresh(drive), Cartographer.from_options(global_=None))
    local = open_loops.local_trajectory()
    others = {"relations": related_poses(logs, drive, local), "poses as published": published_poses(logs, drive)}
    result["closures_by"] = {name: closures(engine, poses) for name, poses in others.items()}
    return {**result, "closures": closures(engine, corrected_poses(logs, drive, local))}


def simulated(folder: str, name: str) -> dict[str, Any]:
    """Return the errors on a simulated log of `SIMULATED`."""
    case = SIMULATED[name]
    drive = read_carmen(Path(folder) / f"{case.log}.log.gz")
    truth = read_tum(Path(folder) / f"{case.truth}.gt.tum").poses
    if case.tracked:
        filtered = filtered_scans(drive, PeopleFilterConfig(forest="simulation"))
        drive = replace(drive, scans=[scan.without_people for scan in filtered])
    engine, timing = _driven(drive)
    result = {**_counts(engine), "closures": closures(engine, truth), TIMING: timing}
    for kind, poses in (("final", engine.trajectory()), ("online", engine.online_trajectory())):
        error = absolute_error(poses, truth).translation
        result[kind] = {"ate_m": error.rmse, "max_m": error.max}
    return result


def local_speed(folder: str, name: str, beams: int | None) -> dict[str, Any]:
    """Return the speed of local SLAM alone on a simulated log, best of some repeats.

    Args:
        folder: Of the logs.
        name: Of the log.
        beams: How many beams of each scan are kept; None: all.
    """
    drive = read_carmen(Path(folder) / f"{name}.log.gz")
    first = drive.scans[0]
    if beams is not None:
        opening = float(np.ptp(first.bearings))
        drive = replace(drive, scans=[thinned(scan, beams, opening) for scan in drive.scans])
    runs = [_driven(_fresh(drive), Cartographer.from_options(global_=None))[1] for _ in range(SPEED_REPEATS)]
    best = max(runs, key=lambda timing: timing["scans_per_s"])
    return {"scans": len(drive), "beams": len(drive.scans[0]), TIMING: best}


def closures(engine: Cartographer, reference: Array, within: tuple[float, float] = WITHIN) -> dict[str, Any]:
    """Return how many constraints there are, and how many agree with the reference poses (n, 3).

    A submap lies where the reference puts its nodes: each of them says where the tied node should be, and the median
    counts, since a single pose of a reference is as noisy as what is judged. `searched`: found by a global search;
    `returned`: every tie to a submap that was begun `APART` nodes before; `near`: agrees in position, whatever the
    heading. `within` [m, rad] is what agrees.
    """
    scans, inside = np.array(engine.node_scans), engine.submap_nodes
    ties = [c for c in engine.constraints if c.kind is Kind.INTER]
    returned = [c for c in ties if abs(c.node - next(iter(inside[c.submap]))) > APART]
    submaps = [
        compose(reference[scans[list(nodes)]], inverse(np.array(list(nodes.values())).reshape(-1, 3)))
        for nodes in inside
    ]
    result: dict[str, Any] = {}
    for name, chosen in (("searched", [c for c in ties if c.searched]), ("returned", returned)):
        right, near = 0, 0
        for c in chosen:
            errors = between(c.pose, between(submaps[c.submap], reference[scans[c.node]]))
            error = np.quantile(errors, 0.5, axis=0, method="lower")
            close = bool(np.hypot(error[0], error[1]) <= within[0])
            near += close
            right += close and bool(abs(error[2]) <= within[1])
        result[name] = {"count": len(chosen), "right": right, "near": near}
    return result


def cells(data: Path, reference: Path) -> list[Cell]:
    """Return every cell."""
    made = [
        Cell(name=f"recorded/{log}", function=recorded, arguments={"folder": str(data), "log": log}) for log in LOGS
    ]
    for name in SIMULATED:
        arguments: dict[str, Any] = {"folder": str(reference), "name": name}
        made.append(Cell(name=f"simulated/{name}", function=simulated, arguments=arguments))
    for name, beams in (("rooms-d", None), ("corridor-0p-s0", SPEED_BEAMS), ("meeting-0p-s0", SPEED_BEAMS)):
        arguments = {"folder": str(reference), "name": name, "beams": beams}
        made.append(Cell(name=f"speed/{name}", function=local_speed, arguments=arguments))
    for name in ("corridor-0p-s0", "meeting-0p-s0", "plainslip-0p-s0"):
        arguments = {"folder": str(reference), "name": name, "beams": None}
        made.append(Cell(name=f"latency/{name}", function=local_speed, arguments=arguments))
    return made


def tables(results: Mapping[str, Any]) -> str:
    """Return what came out, as text."""
    real, made, speed = [], [], []
    for name, result in results.items():
        kind, _, log = name.partition("/")
        timing = result[TIMING]
        if kind in ("speed", "latency"):
            rate, kernel = f"{timing['scans_per_s']:.0f}", f"{timing['p50_kernels']:.4f}"
            speed.append((log, str(result["beams"]), rate, f"{timing['p99_ms']:.2f}", kernel))
            continue
        found, back = result["closures"]["searched"], result["closures"]["returned"]
        common = (
            _shares(found), _shares(back), str(result["rejected"]),
            str(result["losses"]), f"{timing['final_s']:.2f} ({timing['final_processor_s']:.2f})",
            f"{timing['p99_ms']:.1f}",
        )  # fmt: skip
        if kind == "recorded":
            errors = [", ".join(f"{v:.4f}" for v in result[when].values()) for when in ("final", "online")]
            real.append((log, *errors, TARGETS[log], LOG_RIVALS[log], *common))
            for reference, counts in result.get("closures_by", {}).items():
                by_it = _shares(counts["searched"]), _shares(counts["returned"])
                real.append((f"{log}, by {reference}", "", "", "", "", *by_it, "", "", "", ""))
        else:
            rival = SIMULATED[log].rival_cm
            row = (log, f"{100 * result['final']['ate_m']:.2f}", f"{100 * result['final']['max_m']:.1f}")
            row += (f"{100 * result['online']['ate_m']:.2f}", "" if rival is None else f"{rival:.2f}")
            made.append((*row, *common))
    shared = ("closures right, near", "returns right, near", "rejected", "lost", "final s (of processors)", "p99 ms")
    parts = [
        format_table(("log", "final [m (deg)]", "online", "target", "best original", *shared), real),
        format_table(("log", "ATE cm", "max cm", "online cm", "best original", *shared), made),
        format_table(("local SLAM", "beams", "scans/s", "p99 ms", "median / numpy kernel"), speed),
    ]
    return "\n\n".join(parts)


def _shares(counts: Mapping[str, int]) -> str:
    return f"{counts['right']}, {counts['near']} of {counts['count']}"


def _driven(drive: RecordedDrive, engine: Cartographer | None = None) -> tuple[Cartographer, dict[str, float]]:
    """Return the engine after a drive, and its times: updates, the final optimisation also by the clock."""
    _warm_up(drive)
    robot, took = engine or Cartographer(), np.empty(len(drive))
    for k, (odometry, scan) in enumerate(zip(drive.odometry, drive.scans, strict=True)):
        start = time.process_time()
        robot.update(odometry, scan)
        took[k] = time.process_time() - start
    start, waited = time.process_time(), time.perf_counter()
    robot.finish()
    final, waited, kernel = time.process_time() - start, time.perf_counter() - waited, reference_kernel_s()
    timing = {
        "scans_per_s": len(drive) / float(took.sum()),
        "p50_ms": 1e3 * float(np.median(took)),
        "p99_ms": 1e3 * float(np.quantile(took, 0.99)),
        "max_ms": 1e3 * float(took.max()),
        "p50_kernels": float(np.median(took)) / kernel,
        "final_s": waited,
        "final_processor_s": final,
        "final_kernels": final / kernel,
        "kernel_ms": 1e3 * kernel,
    }
    return robot, timing


def _warm_up(drive: RecordedDrive) -> None:
    """Let an engine take some scans and close a graph, so that no kernel is compiled while others are timed."""
    engine = Cartographer()
    for k in range(min(60, len(drive))):
        engine.update(drive.odometry[k], replace(drive.scans[k]))
    engine.finish()


def _fresh(drive: RecordedDrive) -> RecordedDrive:
    """Return the drive with scans that have not computed their points yet."""
    return replace(drive, scans=[replace(scan) for scan in drive.scans])


def _counts(engine: Cartographer) -> dict[str, Any]:
    return {
        "nodes": len(engine.node_scans),
        "rejected": engine.rejected,
        "losses": engine.losses,
        "relocalizations": engine.relocalizations,
    }


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("data", type=Path, metavar="DATA", help="holds the folder slam_logs")
    parser.add_argument("reference", type=Path, metavar="REFERENCE", help="simulated logs")
    parser.add_argument("--jobs", type=at_least(1), default=1, help="processes (default: 1)")


def run(options: argparse.Namespace) -> int:
    """Measure, print, write results.json."""
    for folder in (options.data / "slam_logs", options.reference):
        if not folder.is_dir():
            raise InputError(f"{folder} is not a folder")
    results = run_cells(cells(options.data, options.reference), options.out, jobs=options.jobs)
    write_results(options, {"results": results})
    print(tables(results))
    return 0
