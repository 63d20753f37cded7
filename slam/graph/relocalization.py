"""A robot that was carried away while it mapped is looked for on the map that it has."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..localization.localizer import Localizer
from ..occupancy_map import OccupancyMap
from ..scan import LaserScan

Array = NDArray[np.float64]


class Relocalization:
    """Searches a map, scan by scan, until one place stands out and the next scan confirms it.

    Args:
        grid: The map before the robot got lost.
        scans: Odometry poses T_odom_robot (3,) and scans since then, so far.
    """

    def __init__(self, grid: OccupancyMap, scans: Iterable[tuple[Array, LaserScan]]) -> None:
        try:
            self._localizer: Localizer | None = Localizer(grid)
        except InputError:  # hardly anything is mapped yet: there is nothing to be found on
            self._localizer = None
        for odometry, scan in scans:
            self.update(odometry, scan)

    def update(self, odometry: Array, scan: LaserScan) -> Array | None:
        """Return (3,) T_map_robot at this scan, if it confirms the place that earlier ones found; else None."""
        if self._localizer is None:
            return None
        result = self._localizer.update(odometry, scan)
        return result.pose if result.matched and result.belief is None else None
