"""How far a laser sees, along evenly spaced beams that are the same for all of its scans.

Not all lasers have the same beams in every scan: some have a few more or fewer in each turn, and scans from which the
motion of the robot was taken out (`deskewed`) are bent. What they show is told along the beams of the first one.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...slam.geometry import compose
from ...slam.scan import LaserScan
from ...slam.view_kernel import kernel
from .detector import beams_of

Array = NDArray[np.float64]

_ALIKE = 0.1  # of the beams, and of their spacing, scans of one laser differ by less
_BESIDE = 0.25  # of the spacing; beams that are no farther off are the same


class RangeView(NamedTuple):
    """How far a laser sees, in the odometry frame.

    Attributes:
        ranges: (N,) along the beams, the largest range where nothing was hit, 0 where nothing is known [m].
        first: Bearing of the first beam in the laser's frame [rad].
        step: Angle between two beams [rad].
        laser: (3,) T_odom_lidar.
    """

    ranges: Array
    first: float
    step: float
    laser: Array


@dataclass(frozen=True)
class Fan:
    """Evenly spaced beams.

    Attributes:
        count: How many.
        first: Bearing of the first one [rad].
        step: Angle between two [rad].
    """

    count: int
    first: float
    step: float

    @cached_property
    def bearings(self) -> Array:
        """(count,) [rad]."""
        return self.first + self.step * np.arange(self.count, dtype=np.float64)

    def may_be_of(self, scan: LaserScan) -> bool:
        """Whether `scan` may be of the same laser: as many beams, as far apart, but for a tenth."""
        other = fan_of(scan)
        more, wider = abs(other.count - self.count), abs(other.step - self.step)
        return more <= _ALIKE * self.count and wider <= _ALIKE * self.step


def fan_of(scan: LaserScan) -> Fan:
    """Return the beams of a scan, as if they were evenly spaced."""
    if len(scan) == 0:
        return Fan(0, 0.0, 0.0)
    first, last = float(scan.bearings[0]), float(scan.bearings[-1])
    return Fan(len(scan), first, (last - first) / max(len(scan) - 1, 1))


def seen_in(scan: LaserScan, robot_pose: ArrayLike, fan: Fan | None = None) -> RangeView:
    """Return the view of a scan.

    Args:
        scan: Of evenly spaced beams.
        robot_pose: (3,) of the robot.
        fan: Beams along which it is told, where its own are others; each tells what the nearest of the scan's does.
    """
    view = view_of(scan.ranges, beams_of(scan), np.asarray(compose(robot_pose, scan.T_robot_lidar)))
    if fan is None or _is_along(scan, fan):
        return view
    return RangeView(_along(scan.bearings, view.ranges, fan), fan.first, fan.step, view.laser)


def _is_along(scan: LaserScan, fan: Fan) -> bool:
    return len(scan) == fan.count and bool((np.abs(scan.bearings - fan.bearings) <= _BESIDE * fan.step).all())


def _along(bearings: Array, far: Array, fan: Fan) -> Array:
    """Return (count,) how far is seen along a fan, by beams (N,) of which each is `far` (N,); 0 where none is near."""
    if not len(bearings):
        return np.zeros(fan.count)
    behind = 2.0 * np.pi  # beams of a full circle may begin elsewhere
    around = np.concatenate((bearings - behind, bearings, bearings + behind))
    order = np.argsort(around, kind="stable")
    around, wanted = around[order], fan.bearings
    after = np.clip(np.searchsorted(around, wanted), 1, len(around) - 1)
    nearest = after - (wanted - around[after - 1] < around[after] - wanted)
    there = np.abs(around[nearest] - wanted) <= (1.0 + _ALIKE) * fan.step
    return np.where(there, np.tile(far, 3)[order[nearest]], 0.0)


@kernel
def view_of(ranges, beams, lidar):
    """Return the view of `ranges` (N,) along `beams` from `lidar` (3,), T_odom_lidar."""
    far = np.zeros(len(ranges))
    for i in range(len(ranges)):
        if ranges[i] >= beams.range_min:
            far[i] = min(ranges[i], beams.range_max)
    step = (beams.bearings[-1] - beams.bearings[0]) / max(len(ranges) - 1, 1) if len(ranges) else 0.0
    return RangeView(far, beams.bearings[0] if len(ranges) else 0.0, step, lidar)
