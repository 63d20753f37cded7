"""A drive goes in, a map and a trajectory come out."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...slam.engine import make_slam
from ...slam.occupancy_map import OccupancyMap
from ...slam.scan import LaserScan


@dataclass(frozen=True, eq=False)
class MappedDrive:
    """What an engine made of a drive.

    Attributes:
        map: The map.
        trajectory: (n, 3) T_map_robot of every scan, final.
    """

    map: OccupancyMap
    trajectory: NDArray[np.float64]


def map_drive(
    odometry: ArrayLike, scans: Sequence[LaserScan], method: str, resolution: float, **options: Any
) -> MappedDrive:
    """Run an engine over a drive.

    Args:
        odometry: (n, 3) T_odom_robot of each scan.
        scans: The n scans.
        method: Name of the engine.
        resolution: Side of the map's cells [m].
        options: Its configuration, with `seed`.
    """
    engine = make_slam(method, **options)
    poses: Iterable[NDArray[np.float64]] = np.asarray(odometry, dtype=np.float64)
    for pose, scan in zip(poses, scans, strict=True):
        engine.update(pose, scan)
    engine.finish()
    return MappedDrive(engine.map_at(resolution), engine.trajectory())
