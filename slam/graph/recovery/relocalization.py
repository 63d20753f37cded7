"""A robot that was carried away while it mapped is looked for on the map that it has."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...geometry import between, compose
from ...localization.localizer import Localizer
from ...localization.place_map import PlaceMap
from ...occupancy_map import OccupancyMap
from ...scan import LaserScan
from .place_comparison import PlaceComparison, compare_places

Array = NDArray[np.float64]

_SIGMAS, _STEP = 2.0, 0.5  # the odometry's errors over a gap: standard deviations, and metres that err alike


def searchable(grid: OccupancyMap) -> PlaceMap | None:
    """Return a map made ready to be searched; None: hardly anything is mapped yet."""
    try:
        return PlaceMap(grid)
    except InputError:
        return None


@dataclass(frozen=True, eq=False)
class SearchRegion:
    """Where a robot should be that was lost in a gap of the log, but not carried: farther away most only looks alike.

    Attributes:
        limits: (2,) by how much the odometry may be wrong over the gap [m, rad].
        start: (3,) T_map_robot by the odometry where the gap ended.
    """

    limits: Array
    start: Array

    @classmethod
    def across(cls, way: float, sigma: Array, start: Array) -> "SearchRegion":
        """Return the reach after a gap.

        Args:
            way: Across it [m].
            sigma: (2,) standard deviations of the odometry if all its steps erred alike [m, rad], which they do not.
            start: (3,) T_map_robot by the odometry where it ended.
        """
        linear, angular = (_SIGMAS * sigma / np.sqrt(max(way / _STEP, 1.0))).tolist()
        return cls(np.array([linear + 0.5 * way * angular, angular]), start)

    def holds(self, pose: Array, expected: Array) -> bool:
        """Return whether the robot may well be at `pose` (3,) where the odometry has it at `expected` (3,) by now."""
        off = between(self.start, compose(pose, between(expected, self.start)))
        return bool(np.hypot(off[0], off[1]) <= self.limits[0] and abs(off[2]) <= self.limits[1])

    def widened(self, other: "SearchRegion") -> "SearchRegion":
        """Return the reach after this gap and another one."""
        return SearchRegion(self.limits + other.limits, self.start)


class Relocalization:
    """Searches a map, scan by scan, until one place stands out and the next scan confirms it.

    Args:
        place: The map before the robot got lost; None: hardly anything is mapped yet, there is nothing to be found on.
        scans: Odometry poses T_odom_robot (3,) and scans since then, so far.

    Attributes:
        reach: Where the robot should be; None: it may be anywhere.
    """

    def __init__(self, place: PlaceMap | None, scans: Sequence[tuple[Array, LaserScan]]) -> None:
        self._place, self._scans = place, list(scans)
        self._localizer: Localizer | None = None
        self.reach: SearchRegion | None = None

    def compare_places(self, here: Array, trust: float, drift: float = 0.0) -> PlaceComparison | None:
        """Weigh `here` (3,), T_map_robot at the last scan, against the rest of the map; None: there is no map.

        Args:
            here: Where local SLAM has put the robot.
            trust: How many times likelier that is than any other place, before the scans are looked at.
            drift: So far local SLAM may have been led astray [m].
        """
        if self._place is None:
            return None
        return compare_places(self._place, self._scans, here, trust=trust, drift=drift)

    def begin(self, reach: SearchRegion | None = None) -> None:
        """Begin to search, with all scans but the last, which is to come by `update`.

        Args:
            reach: Where the robot should be: elsewhere it is not looked for. None: it may be anywhere.
        """
        self.reach = reach
        if self._place is not None:
            self._localizer = Localizer(self._place)
        scans, self._scans = self._scans[:-1], []
        for odometry, scan in scans:
            self._localized(odometry, scan)

    def update(self, odometry: Array, scan: LaserScan, expected: Array) -> Array | None:
        """Return (3,) T_map_robot at this scan, if it confirms the place that earlier ones found; else None.

        Args:
            odometry: (3,) T_odom_robot.
            scan: The scan.
            expected: (3,) T_map_robot by the odometry since the robot got lost.
        """
        pose = self._localized(odometry, scan)
        within = pose is None or self.reach is None or self.reach.holds(pose, expected)
        return pose if within else None

    def _localized(self, odometry: Array, scan: LaserScan) -> Array | None:
        if self._localizer is None:
            return None
        self._scans = [*self._scans, (odometry, scan)][-self._localizer.config.search.views :]
        result = self._localizer.update(odometry, scan)
        return result.pose if result.matched and result.belief is None else None
