"""What stands or hangs in the room: pixels that belong together in the picture and in space."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...slam.bounds import check_numbers
from ...slam.errors import InputError
from ...slam.view_kernel import kernel
from .planes import Planes, Surface

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class ClusterConfig:
    """Parameters of `find_clusters`.

    Attributes:
        gap: Largest distance between neighbouring points of one cluster, at one metre [m].
        gap_per_m: How much that grows with each metre of depth, as pixels grow [1].
        reach: How far away neighbours are [pixels]; more than 1 bridges pixels that measured nothing.
        least_pixels: Fewest points of a cluster.
        lowest: Points below this height are floor [m].
    """

    gap: float = 0.08
    gap_per_m: float = 0.03
    reach: int = 2
    least_pixels: int = 25
    lowest: float = 0.06

    def __post_init__(self) -> None:
        check_numbers(self)
        for name in self.__dataclass_fields__:
            if not getattr(self, name) > 0:
                raise InputError(f"`{name}` of the clusters must be positive, got {getattr(self, name)}")


@dataclass(frozen=True, eq=False)
class ObjectClusters:
    """k clusters, the largest first.

    Attributes:
        label: (h, w) int32 number of the cluster of each pixel, -1 for none.
        count: (k,) points.
        centres: (k, 3) mean point, level frame [m].
        low: (k, 3) smallest coordinates [m].
        high: (k, 3) largest coordinates [m].
    """

    label: NDArray[np.int32]
    count: NDArray[np.int64]
    centres: Array
    low: Array
    high: Array

    def __len__(self) -> int:
        return len(self.count)


def find_clusters(planes: Planes, config: ClusterConfig | None = None) -> ObjectClusters:
    """Return the clusters of all points that are neither floor nor ceiling nor wall."""
    config = config or ClusterConfig()
    points = planes.points
    fixed = np.isin(planes.surface, (Surface.NOTHING, Surface.FLOOR, Surface.CEILING, Surface.WALL))
    chosen = ~fixed & (np.nan_to_num(points[..., 2]) > config.lowest)
    label = np.empty(chosen.shape, dtype=np.int32)
    grown = connect(points, chosen, config.gap, config.gap_per_m, config.reach, label)
    return _measured(points, label, grown, config.least_pixels)


def _measured(points: Array, label: NDArray[np.int32], grown: int, least: int) -> ObjectClusters:
    """Return what is known of the clusters of at least `least` points, numbered by size."""
    inside = label >= 0
    count = np.bincount(label[inside], minlength=grown)
    order = np.argsort(-count, kind="stable")
    order = order[count[order] >= least]
    number = np.full(grown + 1, -1, dtype=np.int32)
    number[order] = np.arange(len(order))
    label = number[label]
    inside = label >= 0
    of, where = label[inside], points[inside]
    low, high = np.full((len(order), 3), np.inf), np.full((len(order), 3), -np.inf)
    np.minimum.at(low, of, where)
    np.maximum.at(high, of, where)
    total = np.stack([np.bincount(of, where[:, axis], len(order)) for axis in range(3)], axis=-1)
    return ObjectClusters(label, count[order], total / np.maximum(count[order], 1)[:, None], low, high)


@kernel
def connect(points, chosen, gap, gap_per_m, reach, label):
    """Number the connected pieces of the `chosen` pixels in the order of their first pixels; return how many.

    Args:
        points: (h, w, 3) [m].
        chosen: (h, w) which pixels count.
        gap: Largest distance of neighbours at 1 m [m].
        gap_per_m: What is added for each metre of depth beyond [1].
        reach: How far away neighbours are [pixels].
        label: (h, w) int32, written; -1 where not chosen.
    """
    height, width = chosen.shape
    queue = np.empty(height * width, dtype=np.int64)
    label[:] = -1
    found = 0
    for start in range(height * width):
        if not chosen[start // width, start % width] or label[start // width, start % width] >= 0:
            continue
        label[start // width, start % width] = found
        queue[0], head, tail = start, 0, 1
        while head < tail:
            row, col = queue[head] // width, queue[head] % width
            head += 1
            p = points[row, col]
            near = gap + gap_per_m * max(p[0] - 1.0, 0.0)
            for i in range(max(0, row - reach), min(height, row + reach + 1)):
                for j in range(max(0, col - reach), min(width, col + reach + 1)):
                    if not chosen[i, j] or label[i, j] >= 0:
                        continue
                    q = points[i, j]
                    if (p[0] - q[0]) ** 2 + (p[1] - q[1]) ** 2 + (p[2] - q[2]) ** 2 < near * near:
                        label[i, j] = found
                        queue[tail] = i * width + j
                        tail += 1
        found += 1
    return found
