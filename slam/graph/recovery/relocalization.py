"""Relocalization: a robot that got lost while it mapped is searched for on the map that it has."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ...localization.hypotheses import HypothesesConfig
from ...localization.localizer import Localizer, LocalizerConfig
from ...localization.place_map import PlaceMap
from ...scan import LaserScan
from .search_region import SearchRegion

Array = NDArray[np.float64]

# The map is of a minute ago, by the same laser: what fits it badly is elsewhere, and a look around decides.
_FRESH_MAP = LocalizerConfig(hypotheses=HypothesesConfig(evidence=4.0), fresh=2.5)


class Relocalization:
    """Searches a map, scan by scan, until one place stands out and the next scan confirms it.

    Args:
        place: The map before the robot got lost; None: hardly anything is mapped yet, there is nothing to be found on.
        scans: Odometry poses T_odom_robot (3,) and scans since then, so far. The last of them is to come by `update`.
        region: Where the robot should be: elsewhere it is not looked for. None: it may be anywhere.

    Attributes:
        region: As given.
    """

    def __init__(
        self, place: PlaceMap | None, scans: Sequence[tuple[Array, LaserScan]], region: SearchRegion | None = None
    ) -> None:
        self._localizer = None if place is None else Localizer(place, _FRESH_MAP)
        self.region = region
        for odometry, scan in scans[:-1]:
            self._localized(odometry, scan)

    def update(self, odometry: Array, scan: LaserScan, expected: Array) -> Array | None:
        """Return (3,) T_map_robot at this scan, if it confirms the place that earlier ones found; else None.

        Args:
            odometry: (3,) T_odom_robot.
            scan: The scan.
            expected: (3,) T_map_robot by the odometry since the robot got lost.
        """
        pose = self._localized(odometry, scan)
        within = pose is None or self.region is None or self.region.holds(pose, expected)
        return pose if within else None

    @property
    def searching(self) -> bool:
        """Whether no place is known now."""
        return self._localizer is None or self._localizer.pose is None

    def _localized(self, odometry: Array, scan: LaserScan) -> Array | None:
        if self._localizer is None:
            return None
        result = self._localizer.update(odometry, scan)
        return result.pose if result.matched and result.belief is None else None
