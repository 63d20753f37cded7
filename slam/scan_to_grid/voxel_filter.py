"""Thins a scan to one point a voxel, so that near, dense walls do not outvote far ones (Hess et al. 2016)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..bounds import Cell, Reach, check_numbers
from ..errors import InputError
from ..view_kernel import kernel

Points = NDArray[np.float64]

_EDGE_RATIO = 2.0**-0.5  # neighbouring edges of the adaptive filter's ladder
_TABLE_FACTOR = 4  # slots of the hash table for each point


@dataclass(frozen=True, kw_only=True)
class AdaptiveVoxelConfig:
    """Settings of `AdaptiveVoxelFilter`.

    Attributes:
        min_points: The filter keeps at least so many points where the scan has them.
        max_edge: Longest edge of a voxel [m].
        min_edge: Shortest edge of a voxel [m].
        max_range: Points farther than this from the robot are dropped [m].
    """

    min_points: int = 200
    max_edge: Cell = 0.5
    min_edge: Cell = 0.02
    max_range: Reach = 60.0

    def __post_init__(self) -> None:
        check_numbers(self)
        if self.min_points < 1:
            raise InputError(f"`min_points` must be at least 1, got {self.min_points}")
        if not 0.0 < self.min_edge <= self.max_edge:
            raise InputError(f"need 0 < `min_edge` <= `max_edge` [m], got {self.min_edge} and {self.max_edge}")
        if not self.max_range > 0.0:
            raise InputError(f"`max_range` must be positive [m], got {self.max_range}")


class AdaptiveVoxelFilter:
    """Keeps one point in each voxel, with the longest edge that still leaves enough points.

    Args:
        config: Settings.
    """

    def __init__(self, config: AdaptiveVoxelConfig) -> None:
        self._config = config
        count = 1 + round(np.log(config.min_edge / config.max_edge) / np.log(_EDGE_RATIO))
        self._edges = config.max_edge * _EDGE_RATIO ** np.arange(max(count, 1), dtype=np.float64)

    def apply(self, points: Points) -> Points:
        """Return (M, 2) points of `points` (N, 2) [m], in their order."""
        config = self._config
        near = _nearer(points, config.max_range)
        if len(near) <= config.min_points:
            return near
        return near[_thin(near, self._edges, config.min_points)]


@kernel
def _nearer(points: Points, limit: float) -> Points:
    """Return those points (N, 2) that lie at most `limit` [m] from the origin."""
    kept = np.empty_like(points)
    count = 0
    for k in range(len(points)):
        if points[k, 0] * points[k, 0] + points[k, 1] * points[k, 1] <= limit * limit:
            kept[count, 0], kept[count, 1] = points[k, 0], points[k, 1]
            count += 1
    return kept[:count]


@kernel
def _hash(i: int, j: int, mask: int) -> int:
    return ((i * 73856093) ^ (j * 19349663)) & mask


@kernel
def voxel_first(points: Points, edge: float) -> NDArray[np.int64]:
    """Return the indices of the points (N, 2) that are the first in their voxel of side `edge` [m], ascending."""
    size = 16
    while size < _TABLE_FACTOR * len(points):
        size *= 2
    mask = size - 1
    owner = np.full(size, -1, np.int64)
    cells = np.empty((len(points), 2), np.int64)
    kept = np.empty(len(points), np.int64)
    count = 0
    for k in range(len(points)):
        i, j = int(np.floor(points[k, 0] / edge)), int(np.floor(points[k, 1] / edge))
        slot = _hash(i, j, mask)
        while owner[slot] >= 0 and not (cells[owner[slot], 0] == i and cells[owner[slot], 1] == j):
            slot = (slot + 1) & mask
        if owner[slot] < 0:
            owner[slot] = count
            cells[count, 0], cells[count, 1] = i, j
            kept[count] = k
            count += 1
    return kept[:count]


@kernel
def voxel_mean(points: Points, edge: float) -> Points:
    """Return (M, 2) the mean of the points (N, 2) in each voxel of side `edge` [m], by first appearance."""
    size = 16
    while size < _TABLE_FACTOR * len(points):
        size *= 2
    mask = size - 1
    owner = np.full(size, -1, np.int64)
    cells = np.empty((len(points), 2), np.int64)
    sums = np.zeros((len(points), 3))
    count = 0
    for k in range(len(points)):
        i, j = int(np.floor(points[k, 0] / edge)), int(np.floor(points[k, 1] / edge))
        slot = _hash(i, j, mask)
        while owner[slot] >= 0 and not (cells[owner[slot], 0] == i and cells[owner[slot], 1] == j):
            slot = (slot + 1) & mask
        if owner[slot] < 0:
            owner[slot] = count
            cells[count, 0], cells[count, 1] = i, j
            count += 1
        row = owner[slot]
        sums[row, 0] += points[k, 0]
        sums[row, 1] += points[k, 1]
        sums[row, 2] += 1.0
    means = np.empty((count, 2))
    for row in range(count):
        means[row, 0] = sums[row, 0] / sums[row, 2]
        means[row, 1] = sums[row, 1] / sums[row, 2]
    return means


@kernel
def _thin(points: Points, edges: Points, min_points: int) -> NDArray[np.int64]:
    """Return what `voxel_first` keeps with the longest of `edges` (descending) that leaves `min_points`."""
    best = np.arange(len(points))
    low, high = 0, len(edges) - 1
    while low <= high:
        middle = (low + high) // 2
        kept = voxel_first(points, edges[middle])
        if len(kept) >= min_points:
            best = kept
            high = middle - 1
        else:
            low = middle + 1
    return best
