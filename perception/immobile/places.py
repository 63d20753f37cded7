"""Where somebody was recognised, until the laser sees that nobody is there any more.

The camera sees 70 degrees now and then, the laser 270 in each scan: what it meets at such a place is still a person.
"""

import numpy as np
from numpy.typing import NDArray

from ...slam.geometry import compose, inverse, transform_points
from ...slam.scan import LaserScan

Array = NDArray[np.float64]

_CLEAR_SHARE = 0.7


class PeoplePlaces:
    """Places of people, in the map frame.

    Args:
        radius: Returns within this distance of a place are the person's [m].
    """

    def __init__(self, radius: float) -> None:
        self._radius = radius
        self._places = np.zeros((0, 2))
        self._likelihood = np.zeros(0)

    @property
    def places(self) -> Array:
        """(n, 2) where people are believed to be, map frame [m]."""
        return self._places

    def add(self, places: Array, likelihood: Array) -> None:
        """Add `places` (n, 2) of people, map frame [m]; those near to an older one replace it."""
        apart = np.hypot(*(self._places[:, None] - places[None]).transpose(2, 0, 1))
        kept = ~(apart < self._radius).any(axis=1)
        self._places = np.concatenate((self._places[kept], places))
        self._likelihood = np.concatenate((self._likelihood[kept], likelihood))

    def update(self, T_map_robot: Array, scan: LaserScan) -> Array:
        """Forget the places that `scan`, taken at `T_map_robot` (3,), finds empty.

        Returns:
            (N,) for each beam how likely it met a person of these places; 0 where it did not.
        """
        T_lidar_map = inverse(compose(T_map_robot, scan.T_robot_lidar))
        met, stays = np.zeros(len(scan)), np.ones(len(self._places), dtype=bool)
        points = scan.beam_points
        for k, centre in enumerate(transform_points(T_lidar_map, self._places)):
            away = np.hypot(points[:, 0] - centre[0], points[:, 1] - centre[1])
            on = away < self._radius
            distance = float(np.hypot(*centre))
            half = np.arctan2(0.5 * self._radius, max(distance, self._radius))
            across = np.abs(np.angle(np.exp(1j * (scan.bearings - np.arctan2(centre[1], centre[0]))))) < half
            beyond = across & (scan.ranges > distance + self._radius)
            stays[k] = not (not on.any() and beyond.sum() > _CLEAR_SHARE * max(across.sum(), 1))
            met[on] = np.maximum(met[on], self._likelihood[k])
        self._places, self._likelihood = self._places[stays], self._likelihood[stays]
        return met
