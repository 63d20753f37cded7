"""Whether a log's odometry is grossly wrong: pairs of its scans are matched without it, and both motions compared.

A driver with a wrong wheel radius or track, a swapped sign or mixed-up units gives odometry that is off by a factor.
SLAM may survive that on a good log and break on the next; who drives the robot should hear of it.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..geometry import between, compose
from ..logs.drive import RecordedDrive
from ..scan import LaserScan
from ..scan_to_scan import make_matcher

Array = NDArray[np.float64]

_PAIRS = 100  # pairs of scans that are looked at, evenly over the drive
_FAR = (0.3, 0.35)  # [m, rad] of odometry between the two scans of a pair ...
_MOST_SCANS = 16  # ... or so many scans, where the odometry hardly moves
_LEAST = (0.15, 0.17)  # [m, rad] a pair with a smaller motion by its scans says nothing of a factor
_BEAMS = 180  # of a scan are enough
_KNOWN = 0.05  # [m] a match is known worse than this along a corridor
_ENOUGH = 10  # pairs that a verdict needs
_RIGHT = (0.8, 1.25)  # factors that are no gross error: floors, payload and tyres make a few percent


@dataclass(frozen=True)
class OdometryFactors:
    """What odometry says for what the scans show: 1 is right; `nan` where too few pairs of scans tell.

    Attributes:
        translation: Metres in the direction that the scans show, for each metre of theirs.
        rotation: Radians for each radian that the scans show.
        pairs: How many pairs of scans told (translation, rotation).
    """

    translation: float
    rotation: float
    pairs: tuple[int, int]

    @property
    def complaint(self) -> str | None:
        """What is grossly wrong, in one line; None: nothing that could be told."""
        said = []
        for value, unit, count in zip((self.translation, self.rotation), ("metre", "radian"), self.pairs, strict=True):
            if np.isfinite(value) and not _RIGHT[0] <= value <= _RIGHT[1]:
                said.append(f"{value:.2f} {unit}s for each {unit} that the scans show ({count} pairs of scans)")
        return f"odometry is grossly wrong: it says {', and '.join(said)}" if said else None


def odometry_factors(drive: RecordedDrive) -> OdometryFactors:
    """Return by which factors the odometry of a drive is off, by the median over pairs of scans.

    The pairs are matched on the whole circle and 2 m around no motion at all, so that nothing of the odometry enters.
    Along a corridor, where a match is blind, and where several places fit, a pair does not count.

    Args:
        drive: With odometry.
    """
    tool, ratios = make_matcher("global", second_maxima=0), ([], [])
    last = len(drive) - 1
    for first in np.unique(np.linspace(0, max(last - 1, 0), _PAIRS).astype(np.int64)):
        second = _partner(drive.odometry, int(first), last)
        if second is None:
            continue
        a, b = thinned(drive.scans[first]), thinned(drive.scans[second])
        found = tool.match(a, b, (0.0, 0.0, 0.0))
        if not found.converged or np.linalg.eigvalsh(found.covariance[:2, :2])[-1] > _KNOWN**2:
            continue
        seen = compose(compose(np.asarray(a.T_robot_lidar), found.pose), between(b.T_robot_lidar, np.zeros(3)))
        said = between(drive.odometry[first], drive.odometry[second])
        way = float(seen[:2] @ seen[:2])
        if way > _LEAST[0] ** 2:
            ratios[0].append(float(said[:2] @ seen[:2]) / way)
        if abs(seen[2]) > _LEAST[1]:
            ratios[1].append(float(said[2] / seen[2]))
    factors = [float(np.median(r)) if len(r) >= _ENOUGH else float("nan") for r in ratios]
    return OdometryFactors(factors[0], factors[1], (len(ratios[0]), len(ratios[1])))


def thinned(scan: LaserScan) -> LaserScan:
    """Return a scan of fewer beams: enough of them to match it."""
    step = max(1, len(scan) // _BEAMS)
    return replace(scan, ranges=scan.ranges[::step], bearings=scan.bearings[::step])


def _partner(odometry: Array, first: int, last: int) -> int | None:
    """Return the scan that makes a pair with `first`: where the odometry has gone far enough, or some scans later."""
    for second in range(first + 1, min(first + _MOST_SCANS, last) + 1):
        motion = between(odometry[first], odometry[second])
        if np.hypot(motion[0], motion[1]) >= _FAR[0] or abs(motion[2]) >= _FAR[1]:
            return second
    return min(first + _MOST_SCANS, last) if first < last else None
