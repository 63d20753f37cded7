"""One sweep of a planar laser scanner."""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from .bounds import LARGEST_BEARING, LEAST_SPACING, LONGEST_RANGE_M, MOST_BEAMS, check_mount, check_time
from .errors import InputError, shown
from .geometry import transform_points
from .scan_kernel import fill_beam_points, returns


@dataclass(frozen=True, eq=False)
class LaserScan:
    """Ranges along known bearings, at one time.

    What a range says: finite and within [`range_min`, `range_max`] is a *return*; larger than `range_max`, or `inf`, is
    *no return* (nothing was hit up to `range_max`); NaN or below `range_min` is *no measurement* (dropped, filtered or
    invalid: nothing is known about that beam).

    Attributes:
        ranges: (N,) distances along the beams [m].
        bearings: (N,) directions of the beams in the laser frame [rad], x forward, counter-clockwise, ascending.
        range_min: Shortest valid range [m].
        range_max: Longest valid range [m].
        time_s: Time of the sweep [s].
        T_robot_lidar: Pose (x, y, theta) of the laser in the robot frame [m, m, rad].

    Raises:
        InputError: If shapes, limits or bearings make no sense, or a number is beyond what `bounds` says it can be.
    """

    ranges: NDArray[np.float64]
    bearings: NDArray[np.float64]
    range_min: float
    range_max: float
    time_s: float = 0.0
    T_robot_lidar: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        ranges = np.asarray(self.ranges, dtype=np.float64)
        bearings = np.asarray(self.bearings, dtype=np.float64)
        if ranges.ndim != 1 or ranges.shape != bearings.shape:
            raise InputError(
                f"`ranges` and `bearings` must both have shape (N,), got {ranges.shape} and {bearings.shape}"
            )
        if len(ranges) > MOST_BEAMS:
            raise InputError(f"a scan must have {MOST_BEAMS} beams at most, got {len(ranges)}")
        if not 0.0 <= self.range_min < self.range_max <= LONGEST_RANGE_M:
            raise InputError(
                f"need 0 <= `range_min` < `range_max` <= {LONGEST_RANGE_M:g} [m], got {self.range_min} and "
                f"{self.range_max}"
            )
        check_time(self.time_s)
        check_mount(self.T_robot_lidar)
        object.__setattr__(self, "ranges", ranges)
        object.__setattr__(self, "bearings", _ascending(bearings.tobytes()))

    def __len__(self) -> int:
        return len(self.ranges)

    @property
    def is_return(self) -> NDArray[np.bool_]:
        """(N,) whether the beam hit something within [`range_min`, `range_max`]."""
        return (self.ranges >= self.range_min) & (self.ranges <= self.range_max)

    @property
    def is_no_return(self) -> NDArray[np.bool_]:
        """(N,) whether the beam is known to have met nothing up to `range_max`."""
        return self.ranges > self.range_max

    @property
    def is_open(self) -> NDArray[np.bool_]:
        """(N,) whether the beam and those beside it met nothing: space is free there.

        A laser misses glass, what is dark and what it grazes: fewer such beams in a row say nothing of what is there.
        """
        nothing = self.is_no_return
        around = nothing.copy()
        around[1:] &= nothing[:-1]
        around[:-1] &= nothing[1:]
        return around

    @property
    def directions(self) -> NDArray[np.float64]:
        """(N, 2) unit vectors along the beams, laser frame; shared by scans with the same bearings."""
        return _directions(self.bearings.tobytes())

    @property
    def beam_points(self) -> NDArray[np.float64]:
        """(N, 2) end points of all beams in the laser frame [m]; NaN where there is no return."""
        points = np.empty((len(self.ranges), 2))
        fill_beam_points(self.ranges, self.directions, self.range_min, self.range_max, points)
        return points

    @property
    def points(self) -> NDArray[np.float64]:
        """(M, 2) end points of the returns in the laser frame [m], in beam order."""
        return _returns(self)[0]

    @property
    def beams(self) -> NDArray[np.int64]:
        """(M,) the beam that each of `points` belongs to."""
        return _returns(self)[1]

    @property
    def points_robot(self) -> NDArray[np.float64]:
        """(M, 2) end points of the returns in the robot frame [m], in beam order."""
        return _points_robot(self)

    def without(self, dropped: NDArray[np.bool_]) -> "LaserScan":
        """Return this scan with the beams where `dropped` (N,) is true turned into "no measurement" (NaN)."""
        return replace(self, ranges=np.where(dropped, np.nan, self.ranges))


# What is computed from a scan is many times as large as the scan, and wanted while it is the newest: it is not kept
# with it, or a long drive would not fit in memory.
@lru_cache(maxsize=8)
def _returns(scan: LaserScan) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    return returns(scan.ranges, scan.directions, scan.range_min, scan.range_max)


@lru_cache(maxsize=8)
def _points_robot(scan: LaserScan) -> NDArray[np.float64]:
    return transform_points(scan.T_robot_lidar, scan.points)


@lru_cache(maxsize=16)
def _ascending(bearings: bytes) -> NDArray[np.float64]:
    """Return `bearings` (N,) float64, one array for all sweeps that share them, if they are within bounds and ascend.

    Raises:
        InputError: If they do not.
    """
    angles = np.frombuffer(bearings)
    if not ((np.abs(angles) <= LARGEST_BEARING).all() and (np.diff(angles) >= LEAST_SPACING).all()):
        raise InputError(
            f"`bearings` must be finite and ascending by {LEAST_SPACING:g} rad at least, within "
            f"{LARGEST_BEARING:.4g} rad, got {shown(angles)}"
        )
    return angles


@lru_cache(maxsize=16)
def _directions(bearings: bytes) -> NDArray[np.float64]:
    """Return (N, 2) unit vectors along `bearings` (N,) float64; sweep after sweep has the same."""
    angles = np.frombuffer(bearings)
    directions = np.stack((np.cos(angles), np.sin(angles)), axis=-1)
    directions.flags.writeable = False
    return directions
