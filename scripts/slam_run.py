"""A recorded drive through a SLAM engine, and the result directory that comes of it."""

import resource
import sys
import tempfile
import time
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from .. import __version__
from ..slam.engine import SlamEngine
from ..slam.errors import InputError
from ..slam.files.output import write_json
from ..slam.geometry import compose
from ..slam.logs.drive import RecordedDrive
from ..slam.logs.ros_map import write_ros_map
from ..slam.logs.tum import Trajectory, write_tum
from ..slam.occupancy_map import OccupancyMap
from ..slam.quality.trajectory import absolute_error, relative_error
from .figures.canvas import save_png
from .figures.trajectory import trajectory_picture
from .lab.hardware import describe_machine


@dataclass(frozen=True, eq=False)
class SlamRun:
    """What an engine made of a drive.

    Attributes:
        trajectory: (n, 3) T_map_robot for each scan, by the best knowledge at the end.
        integrated: (n,) whether a scan was matched and written into the map.
        located: (n,) whether the engine was sure then where on its map the robot is.
        map: The final map.
        wall_s: Time that the engine's updates took together [s].
        first_s: Of it, the first two integrated scans, in which kernels may be compiled [s].
    """

    trajectory: NDArray[np.float64]
    integrated: NDArray[np.bool_]
    located: NDArray[np.bool_]
    map: OccupancyMap
    wall_s: float
    first_s: float


def prepare_folder(folder: Path) -> None:
    """Make the folder for results; fail before the work, not after it, where nothing could be written there."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise InputError(f"{folder}: results cannot be written there ({error.strerror})") from error


def run_slam(
    engine: SlamEngine, drive: RecordedDrive, resolution: float | None = None, progress: bool = True
) -> SlamRun:
    """Feed a whole drive to an engine.

    Args:
        engine: A fresh engine.
        drive: The drive.
        resolution: Side of the cells of the final map [m]; None: the engine's own.
        progress: Whether a bar on stderr shows how far it is.
    """
    integrated, located = np.zeros(len(drive), dtype=np.bool_), np.zeros(len(drive), dtype=np.bool_)
    wall = first = 0.0
    steps = zip(drive.odometry, drive.scans, strict=True)
    pause = 0.1 if sys.stderr.isatty() else 10.0  # between two drawings of the bar; a file needs few
    bar = tqdm(steps, drive.name, len(drive), file=sys.stderr, unit="scan", mininterval=pause, disable=not progress)
    for i, (odometry, scan) in enumerate(bar):
        start = time.perf_counter()
        update = engine.update(odometry, scan)
        took = time.perf_counter() - start
        integrated[i], located[i] = update.integrated, update.located
        wall += took
        first += took if integrated.sum() <= 2 else 0.0
    engine.finish()
    final = engine.map() if resolution is None else engine.map_at(resolution)
    return SlamRun(engine.trajectory(), integrated, located, final, wall, first)


def write_run(
    folder: Path, drive: RecordedDrive, run: SlamRun, settings: dict[str, Any], reference: NDArray[np.float64] | None
) -> dict[str, Any]:
    """Write trajectory.tum, map.pgm, map.yaml, map.png, metrics.json and timing.json; return the metrics.

    Equal runs give equal bytes in all of them but timing.json.

    Args:
        folder: Where to; made if need be.
        drive: The drive.
        run: What the engine made of it.
        settings: How it was made: method, seed, resolved configuration.
        reference: (n, 3) poses to compare with, or None.
    """
    metrics = {**settings, "tagalong": __version__, **run_metrics(drive, run, reference)}
    lines = {"estimate": run.trajectory}
    if reference is not None:
        lines["reference"] = compose(absolute_error(reference, run.trajectory).T_ref_est, reference)
    write_tum(folder / "trajectory.tum", Trajectory(usable_times(drive), run.trajectory))
    write_ros_map(folder / "map", run.map)
    save_png(folder / "map.png", trajectory_picture(run.map, lines, f"{drive.name}, {settings['method']}"))
    write_json(folder / "metrics.json", metrics)
    write_json(folder / "timing.json", run_timing(drive, run))
    return metrics


def usable_times(drive: RecordedDrive) -> NDArray[np.float64]:
    """Return the stamps of the scans (n,) [s]; their numbers 0, 1, ... where the log's clock stood still."""
    if 2 * len(np.unique(drive.times_s)) <= len(drive):
        return np.arange(len(drive), dtype=np.float64)
    return drive.times_s


def run_metrics(drive: RecordedDrive, run: SlamRun, reference: NDArray[np.float64] | None) -> dict[str, Any]:
    """Return what can be said about a run: of its path, its map, and its errors where there is a reference."""
    steps = np.diff(run.trajectory[:, :2], axis=0)
    result: dict[str, Any] = {
        "log": drive.name,
        "scans": len(drive),
        "integrated_scans": int(run.integrated.sum()),
        "not_sure": {"scans": int((~run.located).sum()), "times": _stretches(~run.located)},
        "path_m": float(np.hypot(steps[:, 0], steps[:, 1]).sum()),
        "map": {
            "resolution_m": run.map.resolution,
            "cells": list(run.map.probability.shape),
            "occupied_cells": int(run.map.occupied.sum()),
            "free_m2": float(run.map.free.sum() * run.map.resolution**2),
        },
        "against_reference": None,
    }
    if reference is not None:
        absolute = absolute_error(run.trajectory, reference)
        result["against_reference"] = {
            "ate_m": asdict(absolute.translation),
            "ate_deg": asdict(absolute.rotation),
            "T_ref_est": absolute.T_ref_est.tolist(),
        }
        if len(drive) > 1:
            relative = relative_error(run.trajectory, reference)
            result["against_reference"] |= {
                "rpe_m": asdict(relative.translation),
                "rpe_deg": asdict(relative.rotation),
            }
    return result


def _stretches(flags: NDArray[np.bool_]) -> int:
    return int((np.diff(flags, prepend=False) & flags).sum())


def run_timing(drive: RecordedDrive, run: SlamRun) -> dict[str, Any]:
    """Return scans, times and memory; the only result that may differ between two equal runs."""
    duration = float(drive.times_s[-1] - drive.times_s[0])
    integrated = int(run.integrated.sum())
    return {
        "scans": len(drive),
        "wall_s": run.wall_s,
        "wall_of_first_two_integrated_s": run.first_s,
        "s_per_integrated_scan": (run.wall_s - run.first_s) / max(integrated - 2, 1),
        "log_s": duration,
        "realtime_factor": duration / run.wall_s if duration > 0.0 and run.wall_s > 0.0 else None,
        "peak_memory_mb": peak_memory_mb(),
        "machine": describe_machine(),
    }


def peak_memory_mb() -> float:
    """Return the largest memory that this process ever held [MB]."""
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (1e6 if sys.platform == "darwin" else 1e3)  # bytes there, kilobytes elsewhere
