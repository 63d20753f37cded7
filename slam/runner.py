"""A whole recorded drive through a SLAM engine."""

import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from .engine import SlamEngine
from .occupancy_map import OccupancyMap
from .scan import LaserScan

Progress = Callable[[list[LaserScan]], Iterable[LaserScan]]
"""Wraps the scans of a drive so that somebody sees how far it is; `tqdm.tqdm` is one."""


class Drive(Protocol):
    """Scans in the order of a drive and the odometry at each: `RecordedDrive`, or any other class that has both."""

    @property
    def odometry(self) -> NDArray[np.float64]:
        """(n, 3) T_odom_robot of each scan [m, m, rad]."""
        ...

    @property
    def scans(self) -> list[LaserScan]:
        """The n scans."""
        ...


@dataclass(frozen=True, eq=False)
class SlamRun:
    """What an engine made of a drive.

    Attributes:
        engine: The engine after the drive; it draws the map.
        trajectory: (n, 3) T_map_robot of each scan, by the best knowledge at the end [m, m, rad].
        online: (n, 3) T_map_robot of each scan as it was believed when the scan came.
        integrated: (n,) whether a scan was matched and written into the map.
        located: (n,) whether the engine was sure then where on its map the robot is.
        covariances: (n, 3, 3) of `online`, map frame [m, m, rad]; nan where the engine has none.
        odometry_faults: (n,) whether the engine told that the robot moved otherwise than its odometry says.
        seconds: (n,) time that each update took [s].
    """

    engine: SlamEngine
    trajectory: NDArray[np.float64]
    online: NDArray[np.float64]
    integrated: NDArray[np.bool_]
    located: NDArray[np.bool_]
    covariances: NDArray[np.float64]
    odometry_faults: NDArray[np.bool_]
    seconds: NDArray[np.float64]

    def map(self, resolution: float | None = None) -> OccupancyMap:
        """Draw the final map, with cells of `resolution` [m]; None: of the engine's own."""
        return self.engine.map() if resolution is None else self.engine.map_at(resolution)


def run_slam(
    engine: SlamEngine,
    drive: Drive,
    *,
    progress: Progress | None = None,
    clock: Callable[[], float] = time.perf_counter,
) -> SlamRun:
    """Feed a whole drive to an engine, scan by scan, and return what it knows in the end.

    Example: `run_slam(make_slam("gmapping"), read_log("aces.log.gz"), progress=tqdm).map()`.

    Args:
        engine: A fresh engine.
        drive: The drive.
        progress: Wraps the scans, to show how far it is; None: nothing is shown.
        clock: Tells the time [s]: the wall's, or the processor's (`time.process_time`).
    """
    n = len(drive.scans)
    online, seconds, covariances = np.zeros((n, 3)), np.zeros(n), np.full((n, 3, 3), np.nan)
    integrated, located, faults = np.zeros((3, n), dtype=np.bool_)
    scans = drive.scans if progress is None else progress(drive.scans)
    for i, (odometry, scan) in enumerate(zip(drive.odometry, scans, strict=True)):
        start = clock()
        update = engine.update(odometry, scan)
        seconds[i] = clock() - start
        online[i], integrated[i], located[i] = update.pose, update.integrated, update.located
        if update.covariance is not None:
            covariances[i] = update.covariance
        faults[i] = update.diagnostics.get("odometry_fault", 0.0) > 0.0
    engine.finish()
    return SlamRun(engine, engine.trajectory(), online, integrated, located, covariances, faults, seconds)
