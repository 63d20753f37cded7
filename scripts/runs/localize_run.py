"""A recorded drive localized on a finished map, and the result directory that comes of it."""

import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from ... import __version__
from ...slam.files.output import write_json
from ...slam.localization.localizer import LocalizationUpdate, Localizer
from ...slam.logs.drive import RecordedDrive
from ...slam.logs.tum import Trajectory, write_tum
from ...slam.occupancy_map import OccupancyMap
from ..figures.canvas import save_png
from ..figures.trajectory import trajectory_picture
from ..lab.hardware import describe_machine
from .slam_run import peak_memory_mb, usable_times


@dataclass(frozen=True, eq=False)
class LocalizeRun:
    """What localization made of a drive.

    Attributes:
        trajectory: (n, 3) T_map_robot of each scan; NaN where it was not sure.
        matched: (n,) whether the scan was matched on the map.
        explained: (n,) share of the scan's beams that end at walls of the map; NaN where nothing can be said.
        losses: How often a tracked robot was lost.
        wall_s: (n,) time of each update [s].
    """

    trajectory: NDArray[np.float64]
    matched: NDArray[np.bool_]
    explained: NDArray[np.float64]
    losses: int
    wall_s: NDArray[np.float64]

    @property
    def sure(self) -> NDArray[np.bool_]:
        """(n,) whether there is a pose."""
        return np.isfinite(self.trajectory[:, 0])


def run_localizer(localizer: Localizer, drive: RecordedDrive, progress: bool = True) -> LocalizeRun:
    """Feed a whole drive to a fresh localizer; `progress` shows a bar on stderr."""
    steps = zip(drive.odometry, drive.scans, strict=True)
    pause = 0.1 if sys.stderr.isatty() else 10.0  # between two drawings of the bar; a file needs few
    updates: list[LocalizationUpdate] = []
    wall_s = np.zeros(len(drive))
    bar = tqdm(steps, drive.name, len(drive), file=sys.stderr, unit="scan", mininterval=pause, disable=not progress)
    for i, (odometry, scan) in enumerate(bar):
        start = time.perf_counter()
        updates.append(localizer.update(odometry, scan))
        wall_s[i] = time.perf_counter() - start
    explained = [np.nan if update.explained is None else update.explained for update in updates]
    matched = np.array([update.matched for update in updates], dtype=np.bool_)
    return LocalizeRun(localizer.trajectory(), matched, np.array(explained), localizer.lost, wall_s)


def write_localize_run(
    folder: Path, drive: RecordedDrive, run: LocalizeRun, grid: OccupancyMap, settings: dict[str, Any]
) -> dict[str, Any]:
    """Write trajectory.tum, map.png, metrics.json and timing.json; return the metrics.

    Args:
        folder: Where to; made if need be.
        drive: The drive.
        run: What became of it.
        grid: The map.
        settings: How it was made.
    """
    metrics = {**settings, "tagalong": __version__, **localize_metrics(drive, run)}
    times, sure = usable_times(drive), run.sure
    write_tum(folder / "trajectory.tum", Trajectory(times[sure], run.trajectory[sure]))
    title = f"{drive.name}: sure of {100 * metrics['sure_share']:.1f} % of the scans"
    save_png(folder / "map.png", trajectory_picture(grid, _stretches(run), title))
    write_json(folder / "metrics.json", metrics)
    write_json(
        folder / "timing.json",
        {
            "scans": len(drive),
            "wall_s": float(run.wall_s.sum()),
            "median_ms": float(1e3 * np.median(run.wall_s)),
            "longest_ms": float(1e3 * run.wall_s.max()),
            "peak_memory_mb": peak_memory_mb(),
            "machine": describe_machine(),
        },
    )
    return metrics


def localize_metrics(drive: RecordedDrive, run: LocalizeRun) -> dict[str, Any]:
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


def _stretches(run: LocalizeRun) -> dict[str, NDArray[np.float64]]:
    """Return the path in the pieces between which it was not sure, by the numbers of their scans."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], run.sure, [False]))))
    pieces = [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]
    return {f"scans {a} to {b - 1}": run.trajectory[a:b] for a, b in pieces}
