"""SLAM in buildings that nobody has chosen: floors, lasers, drives, odometry and people, all drawn at random.

Offices, rings of corridors, grids of equal rooms, halls and caves; lasers of 4 to 80 m, 180 to 360 deg and 90 to 720
beams; a scan every 0.1 to 2 s; good to bad odometry; up to six people. Nobody carries the robot: each time that the
engine believes it lost is false. Each world has a kind and a seed, and is the same to the byte on every machine alike.
Beyond: poses farther off, by their covariance, than one in a hundred is where covariances are right.
With --spinning the lasers turn once from scan to scan; `--spinning live` takes the robot's motion out of their scans as
they come, as on a robot; `--spinning left` leaves it in them.
With `--odometry laser` nobody knows what the wheels say: odometry is made of the scans.

example:
  tagalong bench drawn-worlds --engines cartographer gmapping --kinds office --seeds 0 99 --jobs 2
"""

import argparse
import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...envs.simulation2d.building_plans import KINDS
from ...envs.simulation2d.drawn_drives import draw_drive
from ...slam.drives.live_deskewing import Deskewer
from ...slam.drives.made_odometry import with_made_odometry
from ...slam.drives.sweep_time import deskewed
from ...slam.engine import SlamEngine, SlamUpdate, make_slam
from ...slam.errors import InputError
from ...slam.graph.engine import Cartographer
from ...slam.logs.drive import RecordedDrive
from ...slam.quality.consistency import beyond, squared_distances
from ...slam.quality.trajectory import absolute_error
from ..console.arguments import at_least, random_seed
from ..console.tables import format_table
from ..lab.cells import TIMING, Cell, run_cells
from ..lab.hardware import reference_kernel_s
from ..lab.statistics import quantile_interval, share
from .graph_slam import closures
from .results import write_results

Array = NDArray[np.float64]

ENGINES = ("cartographer", "gmapping")
SPINNING = ("out", "live", "left")
ODOMETRY = ("wheels", "laser")
LARGE = 0.3  # ATE that counts as large [m]
RIGHT = (0.5, np.radians(5.0))  # [m, rad] a closure that is farther off is wrong
_WARM_UP = 40  # scans


def world(kind: str, seed: int, engine: str, spinning: str = "", odometry: str = ODOMETRY[0]) -> dict[str, Any]:
    """Return what an engine makes of a drawn world: errors [m], losses, closures, times.

    Args:
        kind: Of building.
        seed: Of the world.
        engine: Its name.
        spinning: Of `SPINNING`; "": the laser measures at once.
        odometry: Of `ODOMETRY`.
    """
    drive = draw_drive(kind, seed, spinning=bool(spinning))
    recording = drive.recording
    if odometry == "laser":
        recording, _ = with_made_odometry(recording)
    elif spinning == "out":
        recording = deskewed(recording)
    elif spinning == "live":
        deskewer = Deskewer()
        pairs = zip(recording.odometry, recording.scans, strict=True)
        recording = replace(recording, scans=[deskewer.update(odometry, scan)[0] for odometry, scan in pairs])
    robot, updates, took = driven(recording, engine)
    result: dict[str, Any] = {
        "scans": len(recording), "traits": asdict(drive.traits), "area_m2": drive.plan.planner.area
    }  # fmt: skip
    start = time.process_time()
    robot.finish()
    result["final"] = _error(robot.trajectory(), drive.truth)
    final_s = time.process_time() - start
    result["odometry"] = _error(recording.odometry, drive.truth)
    result["not_located"] = float(np.mean([not update.located for update in updates]))
    result["beyond"] = _beyond(updates, drive.truth)
    if isinstance(robot, Cartographer):
        result["local"] = _error(robot.local_trajectory(), drive.truth)
        result |= {"losses": robot.losses, "relocalizations": robot.relocalizations, "rejected": robot.rejected}
        found = closures(robot, drive.truth, RIGHT)["searched"]
        result["closures"] = {"count": found["count"], "wrong": found["count"] - found["right"]}
    result[TIMING] = {
        "scans_per_s": len(took) / float(took.sum()),
        "p99_ms": 1e3 * float(np.quantile(took, 0.99)),
        "max_ms": 1e3 * float(took.max()),
        "final_s": final_s,
        "kernel_ms": 1e3 * reference_kernel_s(),
    }
    return result


def driven(drive: RecordedDrive, engine: str) -> tuple[SlamEngine, list[SlamUpdate], Array]:
    """Return an engine after a drive; what it said of each of n scans; (n,) processor time of each [s]."""
    warm = make_slam(engine, seed=0)
    for odometry, scan in zip(drive.odometry[:_WARM_UP], drive.scans[:_WARM_UP], strict=True):
        warm.update(odometry, replace(scan))
    robot, updates, took = make_slam(engine, seed=0), list[SlamUpdate](), np.empty(len(drive))
    for k, (odometry, scan) in enumerate(zip(drive.odometry, drive.scans, strict=True)):
        start = time.process_time()
        updates.append(robot.update(odometry, scan))
        took[k] = time.process_time() - start
    return robot, updates, took


def _beyond(updates: Sequence[SlamUpdate], truth: Array) -> float:
    """Return the share of poses that lie beyond what one in a hundred does by its covariance, where there is any."""
    known = [k for k, update in enumerate(updates) if update.covariance is not None]
    poses = np.array([update.pose for update in updates])
    return beyond(squared_distances(poses[known], np.array([updates[k].covariance for k in known]), truth[known]))


def cells(
    engines: Sequence[str],
    kinds: Sequence[str],
    seeds: Sequence[int],
    spinning: str = "",
    odometry: str = ODOMETRY[0],
) -> list[Cell]:
    """Return every cell."""
    more = {"spinning": spinning} if spinning else {}
    more |= {"odometry": odometry} if odometry != ODOMETRY[0] else {}
    return [
        Cell(
            name="/".join((engine, kind, str(seed), *more.values())),
            function=world,
            arguments={"kind": kind, "seed": seed, "engine": engine, **more},
        )
        for engine in engines
        for seed in seeds
        for kind in kinds
    ]


def summary(results: Mapping[str, Mapping[str, Any]]) -> dict[str, dict[str, Any]]:
    """Return by engine and kind, and by engine over all kinds: errors [m], losses, closures, times."""
    groups: dict[str, list[Mapping[str, Any]]] = {}
    for name, result in results.items():
        engine, kind, *_ = name.split("/")
        for group in (f"{engine}/{kind}", f"{engine}/all"):
            groups.setdefault(group, []).append(result)
    return {name: _summed(groups[name]) for name in sorted(groups)}


def _summed(rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    made: dict[str, Any] = {"n": len(rows)}
    for kind in ("final", "local", "odometry"):
        errors = np.array([row[kind]["rmse_m"] for row in rows if kind in row])
        if len(errors):
            made[kind] = {
                "median_m": float(np.median(errors)),
                "median_interval_m": quantile_interval(errors, 0.5),
                "q90_m": float(np.quantile(errors, 0.9)),
                "q90_interval_m": quantile_interval(errors, 0.9),
                "worst_m": float(errors.max()),
                "large": share([bool(error > LARGE) for error in errors]).to_dict(),
            }
    made |= {key: float(np.mean([row[key] for row in rows])) for key in ("not_located", "beyond")}
    if "losses" in rows[0]:
        made["losses"] = sum(row["losses"] for row in rows)
        made["closures"] = {key: sum(row["closures"][key] for row in rows) for key in ("count", "wrong")}
    timing = {key: [row[TIMING][key] for row in rows] for key in ("scans_per_s", "p99_ms", "max_ms")}
    made[TIMING] = {
        "scans_per_s": float(np.median(timing["scans_per_s"])),
        "p99_ms": float(np.median(timing["p99_ms"])),
        "max_ms": max(timing["max_ms"]),
    }
    return made


def table(summed: Mapping[str, Mapping[str, Any]]) -> str:
    """Return the summary as text."""
    header = (
        "engine, kind", "n", "ATE median", "90 % quantile [m]", "worst", f"share > {LARGE} m", "local median",
        "local 90 %", "odometry", "lost", "not located %", "beyond %", "closures wrong", "scans/s", "p99 ms", "max ms",
    )  # fmt: skip
    rows = []
    for name, row in summed.items():
        final, local, timing = row["final"], row.get("local"), row[TIMING]
        low, high = row["final"]["q90_interval_m"]
        large = "{mean:.2f} [{low:.2f}, {high:.2f}]".format(**final["large"])
        rows.append((
            name, str(row["n"]), f"{final['median_m']:.3f}", f"{final['q90_m']:.2f} [{low:.2f}, {high:.2f}]",
            f"{final['worst_m']:.2f}", large,
            f"{local['median_m']:.2f}" if local else "-", f"{local['q90_m']:.2f}" if local else "-",
            f"{row['odometry']['median_m']:.1f}", str(row.get("losses", "-")), f"{100 * row['not_located']:.1f}",
            f"{100 * row['beyond']:.1f}",
            "{wrong} of {count}".format(**row["closures"]) if "closures" in row else "-",
            f"{timing['scans_per_s']:.0f}", f"{timing['p99_ms']:.0f}", f"{timing['max_ms']:.0f}",
        ))  # fmt: skip
    return format_table(header, rows)


def _error(poses: Array, truth: Array) -> dict[str, float]:
    error = absolute_error(poses, truth).translation
    return {"rmse_m": error.rmse, "max_m": error.max}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("--engines", nargs="+", choices=ENGINES, default=ENGINES[:1], help=f"(default: {ENGINES[0]})")
    parser.add_argument("--kinds", nargs="+", choices=KINDS, default=list(KINDS), help="of buildings (default: all)")
    parser.add_argument(
        "--seeds", type=random_seed, nargs=2, default=(0, 9), metavar=("LOW", "HIGH"),
        help="the worlds of each kind, both ends included (default: 0 9)",
    )  # fmt: skip
    parser.add_argument(
        "--spinning", nargs="?", choices=SPINNING, const=SPINNING[0], default="",
        help="lasers that turn once from scan to scan, the motion meanwhile taken out of their scans, be it as they "
        "come (live), or left in them",
    )  # fmt: skip
    parser.add_argument(
        "--odometry", choices=ODOMETRY, default=ODOMETRY[0],
        help="laser: made of the scans, which lose the motion of a spinning robot by it (default: %(default)s)",
    )  # fmt: skip
    parser.add_argument("--jobs", type=at_least(1), default=1, help="processes (default: 1)")


def run(options: argparse.Namespace) -> int:
    """Measure, print, write results.json."""
    low, high = options.seeds
    if low > high:
        raise InputError(f"--seeds: the first must not be larger than the last, got {low} {high}")
    if options.odometry == "laser" and options.spinning in ("live", "left"):
        raise InputError(f"--odometry laser takes the motion out of the scans; leave out --spinning {options.spinning}")
    worlds = cells(options.engines, options.kinds, range(low, high + 1), options.spinning, options.odometry)
    results = run_cells(worlds, options.out, jobs=options.jobs, label="worlds")
    summed = summary(results)
    write_results(options, {"summary": summed, "worlds": results})
    print(table(summed))
    return 0
