"""The result folder of a recorded drive that was localized on a finished map."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import __version__
from ...slam.files.output import write_json
from ...slam.localization.runner import LocalizerRun
from ...slam.localization.whole_drive import SmoothedDrive
from ...slam.logs.drive import RecordedDrive
from ...slam.logs.tum import Trajectory, write_tum
from ...slam.occupancy_map import OccupancyMap
from ..figures.canvas import save_png
from ..figures.trajectory import trajectory_picture
from ..lab.hardware import describe_machine
from ..lab.memory import peak_memory_mb
from .slam_run import usable_times


def write_localize_run(
    folder: Path,
    drive: RecordedDrive,
    run: LocalizerRun,
    grid: OccupancyMap,
    settings: dict[str, Any],
    smoothed: SmoothedDrive | None = None,
) -> dict[str, Any]:
    """Write trajectory.tum, smoothed.tum, map.png, metrics.json and timing.json; return the metrics.

    Args:
        folder: Where to; made if need be.
        drive: The drive.
        run: What became of it.
        grid: The map.
        settings: How it was made.
        smoothed: The drive as a whole; None: nothing is known of it.
    """
    known = np.isfinite(smoothed.trajectory[:, 0]) if smoothed else np.zeros(len(drive), np.bool_)
    metrics = {
        **settings,
        "tagalong": __version__,
        **localize_metrics(drive, run),
        "whole_drive_probability": smoothed.probability if smoothed else None,
        "whole_drive_share": float(known.mean()) if smoothed else None,
    }
    times, sure = usable_times(drive), run.sure
    write_tum(folder / "trajectory.tum", Trajectory(times[sure], run.trajectory[sure]))
    if smoothed and known.any():
        write_tum(folder / "smoothed.tum", Trajectory(times[known], smoothed.trajectory[known]))
    title = f"{drive.name}: sure of {100 * metrics['sure_share']:.1f} % of the scans"
    save_png(folder / "map.png", trajectory_picture(grid, _stretches(run), title))
    write_json(folder / "metrics.json", metrics)
    write_json(
        folder / "timing.json",
        {
            "scans": len(drive),
            "wall_s": float(run.seconds.sum()),
            "median_ms": float(1e3 * np.median(run.seconds)),
            "longest_ms": float(1e3 * run.seconds.max()),
            "peak_memory_mb": peak_memory_mb(),
            "machine": describe_machine(),
        },
    )
    return metrics


def localize_metrics(drive: RecordedDrive, run: LocalizerRun) -> dict[str, Any]:
    """Return what can be said without a true path: how much was sure, matched and explained, and how even the path is.

    `jumps_m` compares each step between two sure scans with that of the odometry: 95th percentile and largest.
    """
    sure, path, odometry = run.sure, run.trajectory[:, :2], drive.odometry[:, :2]
    steps = np.hypot(*np.diff(path, axis=0).T)
    difference = np.abs(steps - np.hypot(*np.diff(odometry, axis=0).T))
    difference = difference[np.isfinite(difference)]
    explained = run.explained[sure & np.isfinite(run.explained)]
    return {
        "log": drive.name,
        "scans": len(drive),
        "first_sure_scan": int(np.argmax(sure)) if sure.any() else None,
        "sure_share": float(sure.mean()),
        "matched_share": float(run.matched.mean()),
        "lost": run.losses,
        "path_m": float(np.nansum(steps)),
        "explained_median": float(np.median(explained)) if len(explained) else None,
        "jumps_m": [float(np.quantile(difference, 0.95)), float(difference.max())] if len(difference) else None,
    }


def _stretches(run: LocalizerRun) -> dict[str, NDArray[np.float64]]:
    """Return the path in the pieces between which it was not sure, by the numbers of their scans."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], run.sure, [False]))))
    pieces = [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]
    return {f"scans {a} to {b - 1}": run.trajectory[a:b] for a, b in pieces}
