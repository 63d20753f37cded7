"""Clusters of returns: consecutive points closer than alpha, at least beta of them (paper, section II.A)."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...slam.errors import InputError
from ...slam.scan import LaserScan
from ...slam.view_kernel import kernel

DEFAULT_ALPHA = 0.13
DEFAULT_BETA = 3


@dataclass(frozen=True, eq=False)
class Clusters:
    """The clusters of one scan, as slices of the scan's returns in beam order.

    Attributes:
        points: (k, 2) all returns of the scan, in the laser frame [m].
        beams: (k,) the beam that each return belongs to.
        start: (m,) first return of each cluster.
        end: (m,) one past the last return of each cluster.
    """

    points: NDArray[np.float64]
    beams: NDArray[np.int64]
    start: NDArray[np.int64]
    end: NDArray[np.int64]

    def __len__(self) -> int:
        return len(self.start)

    @cached_property
    def sizes(self) -> NDArray[np.int64]:
        """(m,) number of points of each cluster."""
        return self.end - self.start

    @cached_property
    def centres(self) -> NDArray[np.float64]:
        """(m, 2) mean point of each cluster, in the laser frame [m]."""
        sums = np.concatenate((np.zeros((1, 2)), np.cumsum(self.points, axis=0)))
        return (sums[self.end] - sums[self.start]) / np.maximum(self.sizes, 1)[:, None]

    def points_of(self, cluster: int) -> NDArray[np.float64]:
        """(n, 2) the points of one cluster, in the laser frame [m]."""
        return self.points[self.start[cluster] : self.end[cluster]]


LEAST_POINTS = 2
"""No cluster has fewer points, however far: one point has no shape."""


def cluster_scan(
    scan: LaserScan, alpha: float = DEFAULT_ALPHA, beta: int = DEFAULT_BETA, far_width: float = 0.0
) -> Clusters:
    """Split the returns of `scan` where two consecutive ones are more than `alpha` apart; drop the small pieces.

    Beams without a return between two returns do not separate them: only the distance does.

    Args:
        scan: One sweep, of any number of beams.
        alpha: Largest distance between neighbours in a cluster [m].
        beta: Smallest number of points of a cluster.
        far_width: Where a leg of this width gets fewer than `beta` beams, as many as it gets are enough, but at least
            2; 0 asks for `beta` at any distance [m].

    Raises:
        InputError: If `alpha` or `beta` is not positive, or `far_width` is negative.
    """
    if not alpha > 0.0 or beta < 1 or far_width < 0.0:
        raise InputError(
            f"need `alpha` > 0 [m], `beta` >= 1 points, `far_width` >= 0 [m], got {alpha}, {beta}, {far_width}"
        )
    points = scan.points
    spacing = (scan.bearings[-1] - scan.bearings[0]) / max(len(scan) - 1, 1) if len(scan) else 1.0
    start, end = split_by_distance(points, alpha, beta, far_width / spacing if spacing > 0.0 else 0.0)
    return Clusters(points, scan.beams, start, end)


@kernel
def split_by_distance(points, alpha, beta, beams_at_1m=0.0):
    """Return `start` and `end` (m,) of the runs of `points` (k, 2) with steps <= `alpha` and >= `beta` points.

    At a distance r [m], min(`beta`, max(`LEAST_POINTS`, floor(`beams_at_1m` / r))) points are enough, where
    `beams_at_1m` is not 0.
    """
    count = len(points)
    start = np.empty(count, np.int64)
    end = np.empty(count, np.int64)
    found = 0
    first = 0
    for i in range(1, count + 1):
        if i < count:
            dx = points[i, 0] - points[i - 1, 0]
            dy = points[i, 1] - points[i - 1, 1]
            if dx * dx + dy * dy <= alpha * alpha:
                continue
        enough = beta
        if beams_at_1m > 0.0 and LEAST_POINTS <= i - first < beta:
            away = np.hypot(points[first, 0], points[first, 1])
            enough = min(beta, max(LEAST_POINTS, int(beams_at_1m / max(away, 1e-6))))
        if i - first >= enough:
            start[found] = first
            end[found] = i
            found += 1
        first = i
    return start[:found].copy(), end[:found].copy()
