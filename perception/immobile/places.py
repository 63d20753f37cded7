"""Where somebody was recognised, or something has come, until the laser sees that nothing is there any more.

The camera sees 70 degrees now and then, the laser 270 in each scan: what it meets at such a place is still a person.
"""

import numpy as np
from numpy.typing import NDArray

from ...slam.geometry import compose, inverse, transform_points, wrap_angle
from ...slam.scan import LaserScan

Array = NDArray[np.float64]

_CLEAR_SHARE = 0.7
_STANDS_M = 0.15


class Places:
    """Places of what moves, in the map frame.

    Args:
        radius: Returns within this distance of a place belong to what is there [m].
        settles_s: What has stood still for so long does not count any more [s]; infinite for people.
    """

    def __init__(self, radius: float, settles_s: float = float("inf")) -> None:
        self._radius, self._settles_s = radius, settles_s
        self._places = np.zeros((0, 2))
        self._likelihood, self._since = np.zeros(0), np.zeros(0)

    def moving(self, time_s: float) -> Array:
        """Return (n, 2) the places, map frame [m], of what has not settled by then."""
        return self._places[time_s - self._since < self._settles_s]

    def likelihood(self, points: Array) -> Array:
        """Return (n,) how likely what moves is at `points` (n, 2), map frame [m]; 0 where nothing is remembered."""
        apart = np.hypot(*(points[:, None] - self._places[None]).transpose(2, 0, 1))
        return np.where(apart < self._radius, self._likelihood, 0.0).max(axis=1, initial=0.0)

    def transform(self, T_new_old: Array) -> None:
        """Go on in a map frame in which everything near the robot has moved by (3,) `T_new_old`."""
        self._places = transform_points(T_new_old, self._places)

    def add(self, places: Array, likelihood: Array, time_s: float) -> None:
        """Add `places` (n, 2), map frame [m]; each takes over from older ones near to it.

        What is seen within 0.15 m of an older place stands still there.
        """
        apart = np.hypot(*(self._places[:, None] - places[None]).transpose(2, 0, 1))
        since = np.full(len(places), time_s)
        if len(self._places) and len(places):
            oldest = apart.argmin(axis=0)
            stands = apart.min(axis=0) < _STANDS_M
            since = np.where(stands, self._since[oldest], time_s)
            places = np.where(stands[:, None], self._places[oldest], places)
        kept = ~(apart < self._radius).any(axis=1)
        self._places = np.concatenate((self._places[kept], places))
        self._likelihood = np.concatenate((self._likelihood[kept], likelihood))
        self._since = np.concatenate((self._since[kept], since))

    def doubt(self, places: Array, share: float, least: float) -> None:
        """Let what was remembered near to `places` (n, 2), map frame [m], be less likely, `share` of what it was.

        What is then less likely than `least` is forgotten.
        """
        apart = np.hypot(*(self._places[:, None] - places[None]).transpose(2, 0, 1))
        self._likelihood = np.where((apart < self._radius).any(axis=1), share * self._likelihood, self._likelihood)
        kept = self._likelihood >= least
        self._places, self._likelihood, self._since = self._places[kept], self._likelihood[kept], self._since[kept]

    def update(self, T_map_robot: Array, scan: LaserScan) -> Array:
        """Forget the places that `scan`, taken at `T_map_robot` (3,), finds empty.

        Returns:
            (N,) for each beam how likely it met what moves at these places; 0 where it did not.
        """
        T_lidar_map = inverse(compose(T_map_robot, scan.T_robot_lidar))
        met, stays = np.zeros(len(scan)), np.ones(len(self._places), dtype=bool)
        counts = scan.time_s - self._since < self._settles_s
        points = scan.beam_points
        for k, centre in enumerate(transform_points(T_lidar_map, self._places)):
            on = np.hypot(points[:, 0] - centre[0], points[:, 1] - centre[1]) < self._radius
            distance = float(np.hypot(*centre))
            half = np.arctan2(0.5 * self._radius, max(distance, self._radius))
            towards = float(np.arctan2(centre[1], centre[0]))
            across = np.abs(wrap_angle(scan.bearings - towards)) < half
            beyond = across & (scan.ranges > distance + self._radius)
            in_view = scan.bearings[0] <= towards - half and towards + half <= scan.bearings[-1]
            stays[k] = on.any() or not in_view or beyond.sum() <= _CLEAR_SHARE * max(across.sum(), 1)
            if counts[k]:
                met[on] = np.maximum(met[on], self._likelihood[k])
        self._places, self._likelihood = self._places[stays], self._likelihood[stays]
        self._since = self._since[stays]
        return met
