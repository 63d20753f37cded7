"""What stood at a place a moment ago: nothing, something, or nobody knows.

A place that a beam passed a second ago and where something stands now holds what has moved (Wang, Thorpe, Thrun,
"Online simultaneous localization and mapping with detection and tracking of moving objects", ICRA 2003). No map is
drawn for that: a few recent scans are kept whole, each with its pose, and asked.
"""

from dataclasses import dataclass
from typing import Annotated, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...slam.bounds import Within, check_numbers
from ...slam.errors import InputError
from ...slam.view_kernel import kernel, spliced_kernel

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
    count: Annotated[int, Within(1, 1000)] = 8
    radius: float = 0.04
    margin: float = 0.2

    def __post_init__(self) -> None:
        check_numbers(self)
        if not (self.spacing_s > 0.0 and self.count >= 1 and self.radius > 0.0 and self.margin > 0.0):
            raise InputError(f"need positive `spacing_s`, `count`, `radius` and `margin`, got {self}")


KEPT = np.dtype([("count", np.int64), ("time_s", np.float64)])
"""How many scans were kept, also those that are gone, and when the last one was taken [s]."""


class RecentViews(NamedTuple):
    """The recent scans of w lasers; `views_of` has those of one, without the first axis, as kernels take them.

    Attributes:
        ranges: (w, N, k) of the last k scans, in no order, as in `RangeView` [m]; those of one beam lie side by side.
        lasers: (w, k, 3) T_odom_lidar of each.
        kept: (w, 1) of `KEPT`.
    """

    ranges: NDArray[np.float32]
    lasers: Array
    kept: NDArray[Any]


def no_views(lasers: int, beams: int, config: RecentViewsConfig) -> RecentViews:
    """Return that no scan of any of the `lasers`, of so many `beams`, was kept yet."""
    kept = np.zeros((lasers, 1), KEPT)
    kept["time_s"] = -np.inf
    return RecentViews(np.zeros((lasers, beams, config.count), np.float32), np.zeros((lasers, config.count, 3)), kept)


@kernel
def views_of(views, w):
    """Return the views of laser w."""
    return RecentViews(views.ranges[w], views.lasers[w], views.kept[w])


@kernel
def forget_views(views):
    """Let no scan of one laser be kept."""
    views.kept[0].count, views.kept[0].time_s = 0, -np.inf


@kernel
def keep_view(views, view, time_s, spacing_s):
    """Keep `view`, taken at `time_s`, if the one before is old enough, in place of the oldest."""
    kept, slots = views.kept[0], len(views.lasers)
    if time_s - kept.time_s < spacing_s - 1e-9 or len(view.ranges) < 2:
        return
    slot = kept.count % slots
    for i in range(len(view.ranges)):
        views.ranges[i, slot] = view.ranges[i]
    for k in range(3):
        views.lasers[slot, k] = view.laser[k]
    kept.count += 1
    kept.time_s = time_s


@kernel
def shares_empty(views, view, points, radius, margin):
    """Return (n, 2) the shares of the kept scans in which `points` (n, 2), odometry frame, were empty and not.

    What is missing to 1 is the share in which nothing is known of the place. No scan is kept: zeros. The scans were
    taken along the beams of `view`.
    """
    shares, count = np.zeros((len(points), 2)), min(views.kept[0].count, len(views.lasers))
    if count and len(points):
        look_back(views.ranges[:, :count], views.lasers[:count], view.first, view.step, points, radius, margin, shares)
    return shares


@kernel
def shares_empty_now(view, points, radius, margin):
    """Return (n, 2) the same of one scan: zeros and ones."""
    shares, beams = np.zeros((len(points), 2)), len(view.ranges)
    if beams >= 2 and len(points):
        ranges, laser = view.ranges.reshape((beams, 1)), view.laser.reshape((1, 3))
        look_back(ranges, laser, view.first, view.step, points, radius, margin, shares)
    return shares


@kernel
def look_back(ranges, lidars, first, step, points, radius, margin, shares):
    """Write into `shares` (n, 2) in which share of the scans `points` (n, 2) were empty, and in which occupied.

    Args:
        ranges: (N, k) of the scans, their largest range where nothing was hit, 0 where nothing is known [m].
        lidars: (k, 3) T_odom_lidar of each.
        first: Bearing of the first beam [rad].
        step: Angle between two beams [rad].
        points: In the odometry frame [m].
        radius: Beams that pass within this of a point matter [m].
        margin: A return so near to a point is from there; a beam that goes so much farther passes it [m].
        shares: Where to write.
    """
    beams, views = ranges.shape
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
            if is_met(ranges[:, v], first, step, bearing, away, margin):
                shares[i, 1] += 1.0 / views
                continue
            nearest = np.inf
            for b in range(low, high + 1):
                nearest = min(nearest, ranges[b, v])
            if nearest > away + margin:
                shares[i, 0] += 1.0 / views


@kernel
def is_met(ranges, first, step, bearing, away, margin):
    """Return whether a return of `ranges` (N,) is within `margin` of the place at `bearing`, so far `away`.

    It most often is in the middle, where a wall is met again.
    """
    middle, half = (bearing - first) / step, margin / away / step
    nearest, last = int(np.round(middle)), len(ranges) - 1
    if 0 <= nearest <= last and _is_near(ranges[nearest], first + nearest * step - bearing, away, margin):
        return True
    for b in range(max(0, int(np.ceil(middle - half))), min(last, int(np.floor(middle + half))) + 1):
        if _is_near(ranges[b], first + b * step - bearing, away, margin):
            return True
    return False


@spliced_kernel
def _is_near(r, off, away, margin):
    """Return whether a return at `r`, `off` [rad] beside a place so far `away`, is within `margin` of it."""
    return abs(r - away) <= margin and r * r + away * away - 2.0 * r * away * np.cos(off) <= margin * margin
