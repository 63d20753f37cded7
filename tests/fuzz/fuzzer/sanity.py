"""What results that came of hostile input may look like: finite, and of the size of things that robots meet."""

from typing import Any

import numpy as np
from fuzzer.border import require

FARTHEST_M = 1e7
"""No robot drives farther: a quarter of the way round the Earth."""
LATEST_S = 1e12
"""No clock says more: 30,000 years, or nanoseconds taken for seconds of no more than a quarter of an hour."""
LONGEST_RANGE_M = 1e5
MOST_CELLS = 1e8


def sane_poses(poses: Any, what: str = "poses") -> None:
    """Require (n, 3) or (3,) finite poses on Earth."""
    poses = np.asarray(poses, dtype=np.float64)
    require(poses.shape[-1:] == (3,), f"{what} have shape {poses.shape}")
    require(np.isfinite(poses).all(), f"{what} are not finite: {poses[~np.isfinite(poses)][:3]}")
    require(
        np.abs(poses[..., :2]).max(initial=0.0) <= FARTHEST_M,
        f"{what} reach {np.abs(poses[..., :2]).max(initial=0.0):.3g} m",
    )


def sane_times(times: Any) -> None:
    """Require finite times that a clock may say."""
    times = np.asarray(times, dtype=np.float64)
    require(np.isfinite(times).all(), f"times are not finite: {times[~np.isfinite(times)][:3]}")
    require(np.abs(times).max(initial=0.0) <= LATEST_S, f"times reach {np.abs(times).max():.3g} s")


def sane_scan(scan: Any) -> None:
    """Require a scan of finite limits, bearings, time and mount, whose returns lie within the limits."""
    sane_times([scan.time_s])
    sane_poses(scan.T_robot_lidar, "the laser's mount")
    require(0.0 <= scan.range_min < scan.range_max <= LONGEST_RANGE_M, f"limits {scan.range_min}, {scan.range_max}")
    require(np.isfinite(scan.bearings).all(), "bearings are not finite")
    require(
        np.abs(scan.bearings).max(initial=0.0) <= 1e3, f"bearings reach {np.abs(scan.bearings).max(initial=0.0):.3g}"
    )
    require(np.isfinite(scan.points).all(), "points are not finite")


def sane_drive(drive: Any) -> None:
    """Require poses, times and scans of a drive."""
    require(len(drive) > 0, "a drive without scans")
    sane_poses(drive.odometry, "odometry")
    if drive.reference is not None:
        sane_poses(drive.reference, "reference poses")
    for scan in drive.scans:
        sane_scan(scan)


def sane_map(grid: Any) -> None:
    """Require a map of probabilities at a place on Earth."""
    require(0 < grid.probability.size <= MOST_CELLS, f"a map of shape {grid.probability.shape}")
    require(0.0 < grid.resolution < 1e3, f"resolution {grid.resolution}")
    sane_poses([*grid.origin, 0.0], "the map's origin")
    known = grid.probability[~np.isnan(grid.probability)]
    require(((known >= 0.0) & (known <= 1.0)).all(), "probabilities beyond [0, 1]")


def finite(values: Any, what: str, most: float = np.inf) -> None:
    """Require finite numbers, none larger than `most`."""
    values = np.asarray(values, dtype=np.float64)
    require(np.isfinite(values).all(), f"{what}: not finite: {values[~np.isfinite(values)][:3]}")
    require(np.abs(values).max(initial=0.0) <= most, f"{what}: up to {np.abs(values).max(initial=0.0):.3g}")
