"""A robot that was carried away while it mapped is looked for on the map that it has."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..localization.contest import Contest, contest, fits
from ..localization.localizer import Localizer
from ..localization.place_map import PlaceMap
from ..occupancy_map import OccupancyMap
from ..scan import LaserScan

Array = NDArray[np.float64]

_DOUBTED = 10.0  # how many times likelier than elsewhere the robot is where it was not sure to be before


def searchable(grid: OccupancyMap) -> PlaceMap | None:
    """Return a map made ready to be searched; None: hardly anything is mapped yet."""
    try:
        return PlaceMap(grid)
    except InputError:
        return None


class Relocalization:
    """Searches a map, scan by scan, until one place stands out and the next scan confirms it.

    Args:
        place: The map before the robot got lost; None: hardly anything is mapped yet, there is nothing to be found on.
        scans: Odometry poses T_odom_robot (3,) and scans since then, so far.
    """

    def __init__(self, place: PlaceMap | None, scans: Sequence[tuple[Array, LaserScan]]) -> None:
        self._place, self._scans = place, list(scans)
        self._localizer: Localizer | None = None
        self._off_map = False

    def contest(self, here: Array, doubted: bool = False, drift: float = 0.0) -> Contest | None:
        """Weigh `here` (3,), T_map_robot at the last scan, against the rest of the map; None: there is no map.

        Args:
            here: Where local SLAM has put the robot.
            doubted: Whether that did not stand out in an earlier contest.
            drift: So far local SLAM may have been led astray [m].
        """
        if self._place is None:
            return None
        return contest(self._place, self._scans, here, trust=_DOUBTED if doubted else None, drift=drift)

    def begin(self, off_map: bool = False) -> None:
        """Begin to search, with all scans but the last, which is to come by `update`.

        Args:
            off_map: Whether the robot may well be where nothing is mapped: a place must then fit better than none.
        """
        self._off_map = off_map
        if self._place is not None:
            self._localizer = Localizer(self._place)
        scans, self._scans = self._scans[:-1], []
        for odometry, scan in scans:
            self.update(odometry, scan)

    def update(self, odometry: Array, scan: LaserScan) -> Array | None:
        """Return (3,) T_map_robot at this scan, if it confirms the place that earlier ones found; else None."""
        if self._localizer is None:
            return None
        config = self._localizer.config
        self._scans = [*self._scans, (odometry, scan)][-config.search.views :]
        result = self._localizer.update(odometry, scan)
        if result.pose is None or not result.matched or result.belief is not None:
            return None
        if self._off_map and not fits(self._localizer.place, self._scans, result.pose, config):
            return None
        return result.pose
