"""What stood at a place a moment ago: nothing, something, or nobody knows.

A place that a beam passed a second ago and where something stands now holds what has moved (Wang, Thorpe, Thrun,
"Online simultaneous localization and mapping with detection and tracking of moving objects", ICRA 2003). No map is
drawn for that: a few recent scans are kept whole, each with its pose, and asked.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...slam.bounds import check_numbers
from ...slam.errors import InputError
from ...slam.scan import LaserScan
from ...slam.view_kernel import kernel

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class RecentViewsConfig:
    """How far back, and how near is the same place.

    Attributes:
        spacing_s: Time between two scans that are kept: a walker needs as much to leave a leg's width behind [s].
        count: So many are kept.
        radius: A place is empty only if all beams pass that go within this distance of it: half a slim leg [m].
        margin: A return no farther than this from a place is there, in any direction, so that a wall seen along is met,
            too: half a wide leg and what the odometry may be off by within `count` x `spacing_s` [m].
    """

    spacing_s: float = 0.2
    count: int = 8
    radius: float = 0.04
    margin: float = 0.2

    def __post_init__(self) -> None:
        check_numbers(self)
        if not (self.spacing_s > 0.0 and self.count >= 1 and self.radius > 0.0 and self.margin > 0.0):
            raise InputError(f"need positive `spacing_s`, `count`, `radius` and `margin`, got {self}")


class RecentViews:
    """Keeps recent scans of one laser.

    Args:
        config: How many.
    """

    def __init__(self, config: RecentViewsConfig | None = None) -> None:
        self.config = config or RecentViewsConfig()
        self.reset()

    def reset(self) -> None:
        """Forget all scans."""
        self._ranges = np.zeros((0, 0))
        self._lidars = np.zeros((0, 3))  # T_odom_lidar of each
        self._beams = 0.0, 1.0
        self._time_s = -np.inf

    def look(self, points: Array, radius: float | None = None) -> Array:
        """Return (n, 2) the shares of the kept scans in which `points` (n, 2), odometry frame, were empty and not.

        What is missing to 1 is the share in which nothing is known of the place. No scan is kept: zeros. `radius` [m]
        is that of the places, if it is not the configured one.
        """
        shares = np.zeros((len(points), 2))
        if len(self._ranges) and len(points):
            near = radius or self.config.radius, self.config.margin
            look_back(self._ranges, self._lidars, *self._beams, points, *near, shares)
        return shares

    def keep(self, scan: LaserScan, lidar: Array) -> None:
        """Keep `scan`, taken from `lidar` (3,), T_odom_lidar, if the one before is old enough."""
        if scan.time_s - self._time_s < self.config.spacing_s - 1e-9 or len(scan) < 2:
            return
        ranges = np.where(scan.is_return, scan.ranges, np.where(scan.ranges > scan.range_max, scan.range_max, 0.0))
        beams = float(scan.bearings[0]), float(scan.bearings[-1] - scan.bearings[0]) / (len(scan) - 1)
        if self._ranges.shape[1] != len(scan) or beams != self._beams:
            self._ranges, self._lidars = np.zeros((0, len(scan))), np.zeros((0, 3))
        self._beams, self._time_s = beams, scan.time_s
        first = max(0, len(self._ranges) + 1 - self.config.count)
        self._ranges = np.concatenate((self._ranges[first:], ranges[None]))
        self._lidars = np.concatenate((self._lidars[first:], lidar[None]))


@kernel
def look_back(ranges, lidars, first, step, points, radius, margin, shares):
    """Write into `shares` (n, 2) in which share of the scans `points` (n, 2) were empty, and in which occupied.

    Args:
        ranges: (k, N) of the scans, their largest range where nothing was hit, 0 where nothing is known [m].
        lidars: (k, 3) T_odom_lidar of each.
        first: Bearing of the first beam [rad].
        step: Angle between two beams [rad].
        points: In the odometry frame [m].
        radius: Beams that pass within this of a point matter [m].
        margin: A return so near to a point is from there; a beam that goes so much farther passes it [m].
        shares: Where to write.
    """
    views, beams = ranges.shape
    for v in range(views):
        cos, sin = np.cos(lidars[v, 2]), np.sin(lidars[v, 2])
        for i in range(len(points)):
            dx, dy = points[i, 0] - lidars[v, 0], points[i, 1] - lidars[v, 1]
            away = np.sqrt(dx * dx + dy * dy)
            if away < 2.0 * margin:
                continue
            bearing = np.arctan2(cos * dy - sin * dx, cos * dx + sin * dy)
            middle, half = (bearing - first) / step, radius / away / step
            low, high = int(np.ceil(middle - half)), int(np.floor(middle + half))
            if high < low:
                low = high = int(np.round(middle))
            if low < 0 or high >= beams:
                continue
            nearest = np.inf
            for b in range(low, high + 1):
                nearest = min(nearest, ranges[v, b])
            if is_met(ranges[v], first, step, bearing, away, margin):
                shares[i, 1] += 1.0 / views
            elif nearest > away + margin:
                shares[i, 0] += 1.0 / views


@kernel
def is_met(ranges, first, step, bearing, away, margin):
    """Return whether a return of `ranges` (N,) is within `margin` of the place at `bearing`, so far `away`."""
    middle, half = (bearing - first) / step, margin / away / step
    for b in range(max(0, int(np.ceil(middle - half))), min(len(ranges) - 1, int(np.floor(middle + half))) + 1):
        r = ranges[b]
        if abs(r - away) <= margin:
            off = first + b * step - bearing
            if r * r + away * away - 2.0 * r * away * np.cos(off) <= margin * margin:
                return True
    return False
