"""The result folder of a recorded drive that went through a SLAM engine."""

import sys
import tempfile
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from ... import __version__
from ...slam.engine import SlamEngine
from ...slam.errors import InputError
from ...slam.files.output import write_json
from ...slam.geometry import compose
from ...slam.graph.engine import Cartographer
from ...slam.landmarks.landmark_map import LandmarkMapper, write_landmark_map
from ...slam.logs.drive import RecordedDrive
from ...slam.logs.ros_map import write_ros_map
from ...slam.logs.tum import Trajectory, write_tum
from ...slam.occupancy_map import OccupancyMap
from ...slam.quality.trajectory import absolute_error, relative_error
from ...slam.runner import Progress, SlamRun
from ..figures.canvas import save_png
from ..figures.trajectory import trajectory_picture
from ..lab.hardware import describe_machine
from ..lab.memory import peak_memory_mb


def prepare_folder(folder: Path) -> None:
    """Make the folder for results; fail before the work, not after it, where nothing could be written there."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise InputError(f"{folder}: results cannot be written there ({error.strerror})") from error


def progress_bar(name: str, shown: bool) -> Progress:
    """Return what wraps the scans of a drive in a bar on stderr that shows how far it is.

    Args:
        name: Stands before the bar.
        shown: Whether there is one.
    """
    pause = 0.1 if sys.stderr.isatty() else 10.0  # between two drawings of the bar; a file needs few
    return partial(tqdm, desc=name, file=sys.stderr, unit="scan", mininterval=pause, disable=not shown)


def write_run(
    folder: Path,
    drive: RecordedDrive,
    run: SlamRun,
    settings: dict[str, Any],
    reference: NDArray[np.float64] | None,
    resolution: float | None = None,
) -> dict[str, Any]:
    """Write trajectory.tum, map.pgm, map.yaml, map.png, metrics.json and timing.json; return the metrics.

    An engine whose map is made of landmarks gives landmarks.json, too, unless it is sure of none.

    Equal runs give equal bytes in all of them but timing.json.

    Args:
        folder: Where to; made if need be.
        drive: The drive.
        run: What the engine made of it.
        settings: How it was made: method, seed, resolved configuration.
        reference: (n, 3) poses to compare with, or None.
        resolution: Side of the cells of the map [m]; None: the engine's own.
    """
    grid = run.map(resolution)
    metrics = {**settings, "tagalong": __version__, **run_metrics(drive, run, grid, reference)}
    lines = {"estimate": run.trajectory}
    if reference is not None:
        lines["reference"] = compose(absolute_error(reference, run.trajectory).T_ref_est, reference)
    write_tum(folder / "trajectory.tum", Trajectory(usable_times(drive), run.trajectory))
    write_ros_map(folder / "map", grid)
    landmarks = run.engine.landmark_map() if isinstance(run.engine, LandmarkMapper) else None
    if landmarks is not None:
        write_landmark_map(folder / "landmarks.json", landmarks)
    save_png(folder / "map.png", trajectory_picture(grid, lines, f"{drive.name}, {settings['method']}"))
    write_json(folder / "metrics.json", metrics)
    write_json(folder / "timing.json", run_timing(drive, run))
    return metrics


def usable_times(drive: RecordedDrive) -> NDArray[np.float64]:
    """Return the stamps of the scans (n,) [s]; their numbers 0, 1, ... where the log's clock stood still."""
    if 2 * len(np.unique(drive.times_s)) <= len(drive):
        return np.arange(len(drive), dtype=np.float64)
    return drive.times_s


def run_metrics(
    drive: RecordedDrive, run: SlamRun, grid: OccupancyMap, reference: NDArray[np.float64] | None
) -> dict[str, Any]:
    """Return what can be said about a run: of its path, its map, and its errors where there is a reference."""
    steps = np.diff(run.trajectory[:, :2], axis=0)
    result: dict[str, Any] = {
        "log": drive.name,
        "scans": len(drive),
        "integrated_scans": int(run.integrated.sum()),
        "not_sure": {"scans": int((~run.located).sum()), "times": _stretches(~run.located)},
        "standard_deviation_m": _standard_deviation(run.covariances),
        "odometry_not_believed": {"scans": int(run.odometry_faults.sum()), "times": _stretches(run.odometry_faults)},
        "odometry_factors": _odometry_factors(run.engine),
        "path_m": float(np.hypot(steps[:, 0], steps[:, 1]).sum()),
        "map": {
            "resolution_m": grid.resolution,
            "cells": list(grid.probability.shape),
            "occupied_cells": int(grid.occupied.sum()),
            "free_m2": float(grid.free.sum() * grid.resolution**2),
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


def _standard_deviation(covariances: NDArray[np.float64]) -> dict[str, float] | None:
    """Return how well places were known when the scans came, seen from the first [m]; None: the engine does not say."""
    known = covariances[np.isfinite(covariances).all(axis=(1, 2))]
    if not len(known):
        return None
    sigma = np.sqrt(known[:, 0, 0] + known[:, 1, 1])
    return {"median": float(np.median(sigma)), "most": float(sigma.max()), "last": float(sigma[-1])}


def _odometry_factors(engine: SlamEngine) -> dict[str, float] | None:
    """Return what the engine has learned of the wheels and their clock; None: it does not."""
    if not isinstance(engine, Cartographer):
        return None
    way, turn, turn_per_metre = engine.calibration.factors.tolist()
    return {"way": way, "turn": turn, "turn_per_metre": turn_per_metre, "late_s": engine.clock.late_s}


def _stretches(flags: NDArray[np.bool_]) -> int:
    return int((np.diff(flags, prepend=False) & flags).sum())


def run_timing(drive: RecordedDrive, run: SlamRun) -> dict[str, Any]:
    """Return scans, times and memory; the only result that may differ between two equal runs."""
    duration = float(drive.times_s[-1] - drive.times_s[0])
    integrated, wall_s = int(run.integrated.sum()), float(run.seconds.sum())
    first_s = float(run.seconds[np.cumsum(run.integrated) <= 2].sum())  # in which kernels may be compiled
    return {
        "scans": len(drive),
        "wall_s": wall_s,
        "wall_of_first_two_integrated_s": first_s,
        "s_per_integrated_scan": (wall_s - first_s) / max(integrated - 2, 1),
        "log_s": duration,
        "realtime_factor": duration / wall_s if duration > 0.0 and wall_s > 0.0 else None,
        "peak_memory_mb": peak_memory_mb(),
        "machine": describe_machine(),
    }
