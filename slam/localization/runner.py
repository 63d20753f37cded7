"""A whole recorded drive localized on a finished map."""

import time
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..runner import Drive, Progress
from ..scan import LaserScan
from .localizer import LocalizationUpdate


class DriveLocalizer(Protocol):
    """What finds the robot on a map, whatever the map is made of: `Localizer` or `LandmarkLocalizer`.

    Attributes:
        lost: How often a tracked robot was lost.
    """

    lost: int

    @property
    def config(self) -> Any:
        """The resolved configuration, a frozen dataclass."""
        ...

    def update(self, odometry: ArrayLike, scan: LaserScan) -> LocalizationUpdate:
        """Take one scan and the robot's odometry pose T_odom_robot (3,) at that time."""
        ...


@dataclass(frozen=True, eq=False)
class LocalizerRun:
    """What localization made of a drive.

    Attributes:
        trajectory: (n, 3) T_map_robot of each scan; NaN where it was not sure.
        matched: (n,) whether the scan was matched on the map.
        explained: (n,) share of what the scan shows that the map explains: of its beams those that end at walls, or of
            its landmarks those that are known; NaN where nothing can be said.
        losses: How often a tracked robot was lost.
        seconds: (n,) time of each update [s].
    """

    trajectory: NDArray[np.float64]
    matched: NDArray[np.bool_]
    explained: NDArray[np.float64]
    losses: int
    seconds: NDArray[np.float64]

    @property
    def sure(self) -> NDArray[np.bool_]:
        """(n,) whether there is a pose."""
        return np.isfinite(self.trajectory[:, 0])


def run_localizer(localizer: DriveLocalizer, drive: Drive, *, progress: Progress | None = None) -> LocalizerRun:
    """Feed a whole drive to a localizer, scan by scan.

    Args:
        localizer: The localizer; it may have been at work before.
        drive: The drive.
        progress: Wraps the scans, to show how far it is; None: nothing is shown.
    """
    n, lost = len(drive.scans), localizer.lost
    trajectory, explained = np.full((n, 3), np.nan), np.full(n, np.nan)
    matched, seconds = np.zeros(n, dtype=np.bool_), np.zeros(n)
    scans = drive.scans if progress is None else progress(drive.scans)
    for i, (odometry, scan) in enumerate(zip(drive.odometry, scans, strict=True)):
        start = time.perf_counter()
        update = localizer.update(odometry, scan)
        seconds[i] = time.perf_counter() - start
        matched[i] = update.matched
        if update.pose is not None:
            trajectory[i] = update.pose
        if update.explained is not None:
            explained[i] = update.explained
    return LocalizerRun(trajectory, matched, explained, localizer.lost - lost, seconds)
