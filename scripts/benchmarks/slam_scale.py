"""Time and memory of SLAM as buildings and drives grow: campus corridors of equal stretches, drives of kilometres.

Each drive has about 8700 scans of 180 beams a kilometre, which are drawn while it goes on, and runs in a process of its
own. A twentieth of the drive makes a point of the curves. Memory is what the process holds beyond what it held before
the first scan; its most includes the last optimisation.

example:
  tagalong bench slam-scale --sizes 50 200 800 --km 0.5 2 10
"""

import argparse
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ...envs.simulation2d.campus import LEAST_SIZE, CampusDrive, draw_campus_drive
from ...slam.engine import SlamEngine, make_slam
from ...slam.quality.trajectory import absolute_error
from ..console.arguments import random_seed, within
from ..console.tables import format_table
from ..figures.plots import new_figure, require_matplotlib, save_figure
from ..lab.cells import TIMING, Cell
from ..lab.memory import memory_mb, peak_memory_mb
from ..lab.own_process import run_alone
from ..lab.trend import give_back_memory
from .results import write_results
from .slam_faults import ENGINES

POINTS = 20
"""Of the curves of one drive."""
MOST_SIZE, MOST_KM = 2000.0, 100.0
_WARM_UP = 60.0  # way driven first, elsewhere, so that nothing is compiled or loaded while others are timed [m]


def grown(size: float, km: float, engine: str, seed: int) -> dict[str, Any]:
    """Return what a drive through a campus costs an engine: points of its curves, the end, and its error.

    Args:
        size: Length of the campus [m].
        km: Of the drive.
        engine: Name in `slam_faults.ENGINES`.
        seed: Of campus and drive.
    """
    warm = _new(engine)
    _drive(warm, draw_campus_drive(LEAST_SIZE, _WARM_UP, seed + 1), 1)
    warm.finish()
    drive = draw_campus_drive(size, 1000.0 * km, seed)
    del warm
    give_back_memory()
    idle, robot = memory_mb(), _new(engine)
    points = _drive(robot, drive, POINTS)
    start = time.process_time()
    robot.finish()
    ending = {"final_s": time.process_time() - start, "end_mb": memory_mb() - idle, "most_mb": peak_memory_mb() - idle}
    error = absolute_error(robot.trajectory(), drive.truth).translation
    way = float(np.hypot(*np.diff(drive.truth[:, :2], axis=0).T).sum()) / 1000.0
    timing = {"idle_mb": idle, "points": [{**point, "memory_mb": point["memory_mb"] - idle} for point in points]}
    return {"scans": len(drive), "km": way, "rmse_m": error.rmse, "max_m": error.max, TIMING: {**timing, **ending}}


def _drive(robot: SlamEngine, drive: CampusDrive, points: int) -> list[dict[str, float]]:
    """Return, after each of so many equal parts of the drive, its share, the time of a scan in it, and the memory."""
    ends, rows, took, before = {round(k * len(drive) / points): k for k in range(1, points + 1)}, [], 0.0, 0
    for k, scan in enumerate(drive.scans(), 1):
        start = time.process_time()
        robot.update(drive.odometry[k - 1], scan)
        took += time.process_time() - start
        if k in ends:
            rows.append({"share": k / len(drive), "scan_ms": 1e3 * took / (k - before), "memory_mb": memory_mb()})
            took, before = 0.0, k
    return rows


def _new(engine: str) -> SlamEngine:
    return make_slam(**ENGINES[engine])


def cells(sizes: Sequence[float], kms: Sequence[float], engines: Sequence[str], seed: int) -> list[Cell]:
    """Return every cell, the cheapest first."""
    return [
        Cell(
            name=f"{engine}/{size:g}m/{km:g}km",
            function=grown,
            arguments={"size": size, "km": km, "engine": engine, "seed": seed},
        )
        for km in sorted(kms)
        for size in sorted(sizes)
        for engine in engines
    ]


def table(results: Mapping[str, Any]) -> str:
    """Return what came out, as text."""
    rows = []
    for name, result in results.items():
        timing = result[TIMING]
        points = timing["points"]
        driven = sum(point["scan_ms"] for point in points) / len(points)
        rows.append((
            name, f"{result['km']:.1f}", str(result["scans"]), f"{driven:.2f}", f"{points[-1]['scan_ms']:.2f}",
            f"{1e-3 * driven * result['scans']:.0f}", f"{timing['final_s']:.1f}", f"{slope_mb(result):.0f}",
            f"{timing['end_mb']:.0f}", f"{timing['most_mb']:.0f}", f"{result['rmse_m']:.2f}", f"{result['max_m']:.1f}",
        ))  # fmt: skip
    titles = ("km", "scans", "ms a scan", "last", "s", "final s", "MB a km", "MB", "most", "ATE [m]", "max")
    return format_table(("engine, size, drive", *titles), rows)


def slope_mb(result: Mapping[str, Any]) -> float:
    """Return by how much memory grows with each kilometre in the second half of a drive [MB/km]."""
    points = result[TIMING]["points"]
    later = points[len(points) // 2 :]
    way = [result["km"] * point["share"] for point in later]
    return float(np.polyfit(way, [point["memory_mb"] for point in later], 1)[0]) if len(later) > 1 else np.nan


def draw_curves(path: Path, results: Mapping[str, Any]) -> Path:
    """Draw the time of a scan and the memory over the way, a line for each drive."""
    figure = new_figure(12.0, 5.0)
    times, memory = figure.subplots(1, 2)
    for name, result in results.items():
        points = result[TIMING]["points"]
        way = [result["km"] * point["share"] for point in points]
        times.plot(way, [point["scan_ms"] for point in points], marker=".", label=name)
        memory.plot(way, [point["memory_mb"] for point in points], marker=".", label=name)
    times.set(xlabel="way [km]", ylabel="time of processor for a scan [ms]", ylim=(0.0, None))
    memory.set(xlabel="way [km]", ylabel="memory beyond the idle process [MB]", ylim=(0.0, None))
    handles, labels = times.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncol=4, frameon=False, fontsize=8)
    return save_figure(path, figure)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument(
        "--sizes",
        type=within(LEAST_SIZE, MOST_SIZE),
        nargs="+",
        default=[50.0, 200.0, 800.0],
        metavar="M",
        help="(default: 50 200 800)",
    )
    parser.add_argument(
        "--km",
        type=within(0.01, MOST_KM),
        nargs="+",
        default=[0.5, 2.0, 10.0],
        help="of drives (default: 0.5 2 10)",
    )
    parser.add_argument("--engines", nargs="+", choices=ENGINES, default=["cartographer"], help="(default: that)")
    parser.add_argument("--seed", type=random_seed, default=0, help="of campus and drives (default: %(default)s)")


def run(options: argparse.Namespace) -> int:
    """Measure, print, write results.json and scale.png."""
    require_matplotlib()
    wanted = cells(options.sizes, options.km, options.engines, options.seed)
    results = {cell.name: run_alone(cell, options.out) for cell in wanted}
    write_results(options, {"results": results})
    draw_curves(options.out / "scale.png", results)
    print(table(results))
    return 0
