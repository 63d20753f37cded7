"""Laps of one log through a SLAM engine: memory and time of each.

A lap is the recorded drive there and back: its scans once in their order and once in reverse, each with its own
odometry, as of a robot that drives its path backwards. So a lap ends where it began, the next follows without a jump,
and after the first there is nothing new to see: whatever still grows then grows for ever.
"""

import time
from collections.abc import Iterator
from dataclasses import asdict, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from ...envs.recording.slow_tour import slow_tour
from ...envs.scenes.catalogue import SCENES
from ...envs.world.world import WorldConfig
from ...slam.drives.log import read_log
from ...slam.engine import SlamEngine, make_slam
from ...slam.logs.drive import RecordedDrive
from ...slam.scan import LaserScan
from ..lab.cells import TIMING
from ..lab.memory import memory_mb
from ..lab.trend import Pace, Row

Array = NDArray[np.float64]

SAMPLE = 20
"""Scans between two looks at the pace of the machine."""


def engine_laps(method: str, log: str, scans: int | None, laps: int) -> dict[str, Any]:
    """Return the rows (see `Row`) of an engine with its defaults, a lap each.

    Args:
        method: Name of the engine.
        log: Path of a log; or name of a scene, whose building is driven through, empty, by simulation.
        scans: How many scans of the log are driven to and fro, from its first on; None for all.
        laps: How many laps.
    """
    drive = _drive(log)
    engine, rows, done, pace = make_slam(method), [], 0, Pace()
    steps = there_and_back(drive, len(drive) if scans is None else min(scans, len(drive)), laps)
    for _ in tqdm(range(laps), f"{method}, {drive.name}", unit="lap"):
        took, count = _lap(engine, next(steps), pace)
        done += count
        step_ms = 1e3 * took / count
        rows.append(asdict(Row(memory_mb=memory_mb(), step_ms=step_ms, reference_ms=pace.read(), done=done)))
    return {"scans": done, TIMING: rows}


def there_and_back(drive: RecordedDrive, scans: int, laps: int) -> Iterator[Iterator[tuple[Array, LaserScan]]]:
    """Yield for each lap its poses (3,) and scans, of the first `scans` of `drive`; their times never go back.

    Each turning point is there once. A stamp of the log stands for its difference from the one before, whichever way;
    where the log's clock stood still, that is 0.1 s.
    """
    order = [*range(scans), *range(scans - 2, 0, -1)]
    stamps = drive.times_s[order].astype(np.float64)
    gaps = np.abs(np.diff(stamps, prepend=stamps[min(1, len(stamps) - 1)]))
    gaps[gaps == 0.0] = 0.1
    clock = np.cumsum(gaps)
    for lap in range(laps):
        yield (
            (drive.odometry[k], replace(drive.scans[k], time_s=float(lap * clock[-1] + clock[place])))
            for place, k in enumerate(order)
        )


def _drive(log: str) -> RecordedDrive:
    return slow_tour(WorldConfig(scene=log), 0).recording if log in SCENES else read_log(log)


def _lap(engine: SlamEngine, steps: Iterator[tuple[Array, LaserScan]], pace: Pace) -> tuple[float, int]:
    """Return the time of processor that the engine took for `steps` [s], and their number."""
    took, count = 0.0, 0
    for odometry, scan in steps:
        if count % SAMPLE == 0:
            pace.sample()
        start = time.process_time()
        engine.update(odometry, scan)
        took += time.process_time() - start
        count += 1
    return took, count
