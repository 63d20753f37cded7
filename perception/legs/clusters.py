"""Clusters of returns: consecutive points closer than alpha, at least beta of them (paper, section II.A)."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ...slam.errors import InputError
from ...slam.scan import LaserScan

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


def cluster_scan(scan: LaserScan, alpha: float = DEFAULT_ALPHA, beta: int = DEFAULT_BETA) -> Clusters:
    """Split the returns of `scan` where two consecutive ones are more than `alpha` apart; drop the small pieces.

    Beams without a return between two returns do not separate them: only the distance does.

    Args:
        scan: One sweep, of any number of beams.
        alpha: Largest distance between neighbours in a cluster [m].
        beta: Smallest number of points of a cluster.

    Raises:
        InputError: If `alpha` or `beta` is not positive.
    """
    if not alpha > 0.0 or beta < 1:
        raise InputError(f"need `alpha` > 0 [m] and `beta` >= 1 points, got {alpha} and {beta}")
    points = scan.points
    start, end = split_by_distance(points, alpha, beta)
    return Clusters(points, np.flatnonzero(scan.is_return), start, end)


@njit(cache=True, nogil=True)
def split_by_distance(points, alpha, beta):
    """Return `start` and `end` (m,) of the runs of `points` (k, 2) with steps <= `alpha` and >= `beta` points."""
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
        if i - first >= beta:
            start[found] = first
            end[found] = i
            found += 1
        first = i
    return start[:found].copy(), end[:found].copy()


def split_by_distance_reference(
    points: NDArray[np.float64], alpha: float, beta: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return what `split_by_distance` returns, in plain numpy."""
    if len(points) == 0:
        return np.empty(0, np.int64), np.empty(0, np.int64)
    breaks = np.flatnonzero(np.sum(np.diff(points, axis=0) ** 2, axis=1) > alpha * alpha) + 1
    start = np.concatenate(([0], breaks))
    end = np.concatenate((breaks, [len(points)]))
    large = end - start >= beta
    return start[large], end[large]
