"""Candidates for people: parts of clusters under one head each (Munaro et al. 2012, section III.B)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...slam.bounds import check_numbers
from ...slam.errors import InputError
from ...slam.view_kernel import kernel
from .clusters import connect
from .margins import margins
from .planes import Planes, Surface

Array = NDArray[np.float64]

_MOST_HEADS = 64
_ALONE = 2
_UNEVEN = 0.1  # what is higher than a head by less may be its own [m]
HIPS = 0.86
"""Half the height of somebody, where the legs end [m]."""


@dataclass(frozen=True, kw_only=True)
class HeadConfig:
    """Parameters of `find_candidates`.

    Attributes:
        gap: Largest distance between neighbouring points of one cluster, at one metre [m].
        gap_per_m: How much that grows with each metre of depth [1].
        reach: How far away neighbours are [pixels]; more than 1 bridges pixels that measured nothing.
        least_pixels: Fewest points of a candidate.
        lowest: A head is no lower than this [m]: those of people who sit are, backs of chairs are lower.
        lowest_cut: What the picture's upper edge cuts reaches this [m], the height of the ankle: how much of somebody
            is below the edge is up to the mount, and feet alone are not told from the floor.
        highest: Points above this belong to nobody [m].
        apart: Heads of one cluster are at least this far from each other, on the floor [m]: people who walk shoulder
            to shoulder were 0.37 m apart.
        radius: Points of a cluster this far from a head's vertical axis are its person's [m].
        near: So are points of any cluster this near, which legs can be that noise has cut off [m].
        thin_wall: A piece of wall that is cut by the picture's edge and narrower than this may be somebody [m].
    """

    gap: float = 0.08
    gap_per_m: float = 0.03
    reach: int = 2
    least_pixels: int = 30
    lowest: float = 1.1
    lowest_cut: float = 0.1
    highest: float = 2.2
    apart: float = 0.3
    radius: float = 0.5
    near: float = 0.3
    thin_wall: float = 0.8

    def __post_init__(self) -> None:
        check_numbers(self)
        for name in self.__dataclass_fields__:
            if not getattr(self, name) > 0:
                raise InputError(f"`{name}` of the heads must be positive, got {getattr(self, name)}")


@dataclass(frozen=True, eq=False)
class Candidates:
    """n things as high as people.

    Attributes:
        label: (h, w) int32 candidate of each pixel, -1 for none.
        heads: (n, 3) highest point of each, level frame [m].
        pixels: (n, 2) its row and column.
        axes: (n, 2) mean of the points below it, down to the waist, level frame [m].
        cut: (n,) bool whether the picture's upper edge cuts it.
    """

    label: NDArray[np.int32]
    heads: Array
    pixels: NDArray[np.int64]
    axes: Array
    cut: NDArray[np.bool_]

    @property
    def legs(self) -> NDArray[np.bool_]:
        """(n,) whether it can only be somebody's legs: the picture's upper edge cuts it below `HIPS`."""
        return self.cut & (self.heads[:, 2] < HIPS)

    def __len__(self) -> int:
        return len(self.heads)


def find_candidates(planes: Planes, config: HeadConfig | None = None) -> Candidates:
    """Return what stands in the frame and is as high as a person."""
    config = config or HeadConfig()
    points = planes.points
    chosen = _standing(planes, config)
    label = np.empty(chosen.shape, dtype=np.int32)
    clusters = connect(points, chosen, config.gap, config.gap_per_m, config.reach, label)
    edge = margins(planes.frame.depth).edge
    join_cut(points, label, clusters, edge, config.apart)
    pixels = np.empty((_MOST_HEADS, 2), dtype=np.int64)
    found = find_heads(points, label, clusters, edge, config.lowest, config.lowest_cut, config.apart, pixels)
    pixels = pixels[:found]
    heads = points[pixels[:, 0], pixels[:, 1]]
    axes = np.empty((found, 2))
    head_axes(points, label, pixels, config.near, axes)
    owner = np.empty_like(label)
    counts = np.zeros(found, dtype=np.int64)
    assign_points(points, label, pixels, axes, config.radius, config.near, owner, counts)
    return _without_small(Candidates(owner, heads, pixels, axes, pixels[:, 0] < edge), counts >= config.least_pixels)


def _standing(planes: Planes, config: HeadConfig) -> NDArray[np.bool_]:
    """Return (h, w) the points that may be somebody's: neither floor nor ceiling nor wall.

    Points alone in space are left out: at the edge of things a pixel's depth lies anywhere between two surfaces. A
    piece of wall that only the picture's edge makes one (`Planes.likelihood` below 1) must be wide to count as such.
    """
    fixed = np.isin(planes.surface, (Surface.NOTHING, Surface.FLOOR, Surface.CEILING, Surface.WALL))
    for region in np.flatnonzero((planes.kinds == Surface.WALL) & (planes.likelihood < 1.0)):
        mine = planes.region == region
        if mine.any() and np.hypot(*np.ptp(planes.points[mine, :2], axis=0)) < config.thin_wall:
            fixed[mine] = False
    chosen = ~fixed & (np.nan_to_num(planes.points[..., 2], nan=np.inf) < config.highest)
    supported = np.empty_like(chosen)
    with_neighbours(planes.points, _ALONE, supported)
    return chosen & supported


def _without_small(candidates: Candidates, kept: NDArray[np.bool_]) -> Candidates:
    number = np.full(len(kept) + 1, -1, dtype=np.int32)
    number[:-1][kept] = np.arange(np.count_nonzero(kept))
    label = number[candidates.label]
    heads, pixels, axes = candidates.heads[kept], candidates.pixels[kept], candidates.axes[kept]
    return Candidates(label, heads, pixels, axes, candidates.cut[kept])


@kernel
def with_neighbours(points, least, supported):
    """Write which points have at least `least` of their eight neighbours at about their own distance.

    Args:
        points: (h, w, 3) [m], NaN where nothing was measured.
        least: How many.
        supported: (h, w) bool, written.
    """
    height, width = supported.shape
    for row in range(height):
        for col in range(width):
            x, beside = points[row, col, 0], 0
            for i in range(max(0, row - 1), min(height, row + 2)):
                for j in range(max(0, col - 1), min(width, col + 2)):
                    beside += abs(points[i, j, 0] - x) < 0.02 + 0.015 * x
            supported[row, col] = beside > least  # the point itself is one of those counted


@kernel
def _by_cluster(label, clusters):
    """Return (start (clusters + 1,), order): the pixels of cluster c, in order, are `order[start[c]:start[c + 1]]`."""
    width = label.shape[1]
    start = np.zeros(clusters + 1, dtype=np.int64)
    for value in label.ravel():
        if value >= 0:
            start[value + 1] += 1
    for c in range(clusters):
        start[c + 1] += start[c]
    order, fill = np.empty(start[clusters], dtype=np.int64), start.copy()
    for flat in range(label.size):
        c = label[flat // width, flat % width]
        if c >= 0:
            order[fill[c]] = flat
            fill[c] += 1
    return start, order


@kernel
def join_cut(points, label, clusters, edge, apart):
    """Make one cluster of those in `label` (h, w) that the first `edge` rows cut within `apart` of each other [m].

    What belongs together above the edge, two legs under one trunk, is apart below it.
    """
    of = np.arange(clusters)
    cut = label[:edge]
    rows, cols = np.nonzero(cut >= 0)
    for m in range(len(rows)):
        p, mine = points[rows[m], cols[m]], cut[rows[m], cols[m]]
        for n in range(m):
            q, other = points[rows[n], cols[n]], cut[rows[n], cols[n]]
            if of[mine] != of[other] and (p[0] - q[0]) ** 2 + (p[1] - q[1]) ** 2 < apart * apart:
                of[of == of[mine]] = of[other]
    for row in range(label.shape[0]):
        for col in range(label.shape[1]):
            if label[row, col] >= 0:
                label[row, col] = of[label[row, col]]


@kernel
def _highest(points, members, free, edge, lowest, lowest_cut):
    """Return the index of the highest of the `free` members that may be a head; -1: none may."""
    width, top, best = points.shape[1], min(lowest, lowest_cut), -1
    for m in range(len(members)):
        row = members[m] // width
        z = points[row, members[m] % width, 2]
        if free[m] and z > top and (z > lowest or (z > lowest_cut and row < edge)):
            top, best = z, m
    return best


@kernel
def find_heads(points, label, clusters, edge, lowest, lowest_cut, apart, pixels):
    """Write the heads' pixels (row, column) cluster by cluster; return how many there are.

    A head is the highest point of all that are not within `apart` of a higher head of its cluster; and no point of the
    cluster within `apart` is higher, but by noise where the picture's edge cuts it.

    Args:
        points: (h, w, 3) level frame [m].
        label: (h, w) cluster of each pixel, -1 for none.
        clusters: How many clusters there are.
        edge: So many rows are the picture's upper edge.
        lowest: Least height of a head [m].
        lowest_cut: The same in the picture's first rows [m].
        apart: Least distance between heads [m].
        pixels: (k, 2) written.
    """
    width = label.shape[1]
    start, order = _by_cluster(label, clusters)
    found = 0
    for c in range(clusters):
        members = order[start[c] : start[c + 1]]
        free = np.ones(len(members), dtype=np.bool_)
        while found < len(pixels):
            best = _highest(points, members, free, edge, lowest, lowest_cut)
            if best < 0:
                break
            p, is_head = points[members[best] // width, members[best] % width], True
            top = p[2]
            for m in range(len(members)):
                q = points[members[m] // width, members[m] % width]
                if (p[0] - q[0]) ** 2 + (p[1] - q[1]) ** 2 < apart * apart:
                    is_head = is_head and (q[2] <= top or (free[m] and q[2] < top + _UNEVEN))
                    free[m] = False
            if is_head:
                pixels[found, 0], pixels[found, 1] = members[best] // width, members[best] % width
                found += 1
    return found


@kernel
def head_axes(points, label, pixels, near, axes):
    """Write the axis (x, y) of each head: the mean of its cluster's points within `near` of it, down to 0.8 m below."""
    height, width = label.shape
    total = np.zeros((len(pixels), 3))
    for row in range(height):
        for col in range(width):
            if label[row, col] < 0:
                continue
            p = points[row, col]
            for k in range(len(pixels)):
                i, j = pixels[k]
                if label[i, j] != label[row, col]:
                    continue
                q = points[i, j]
                if (p[0] - q[0]) ** 2 + (p[1] - q[1]) ** 2 < near * near and p[2] > q[2] - 0.8:
                    total[k, 0] += p[0]
                    total[k, 1] += p[1]
                    total[k, 2] += 1.0
    for k in range(len(pixels)):
        axes[k] = total[k, :2] / total[k, 2]


@kernel
def assign_points(points, label, pixels, axes, radius, near, owner, counts):
    """Write the candidate whose axis is nearest to each point, and how many points each has.

    Args:
        points: (h, w, 3) [m].
        label: (h, w) cluster of each pixel, -1 for none.
        pixels: (n, 2) row and column of the heads.
        axes: (n, 2) [m].
        radius: Farthest point of the head's own cluster [m].
        near: Farthest point of another one [m].
        owner: (h, w) int32 written, -1 for none.
        counts: (n,) written.
    """
    height, width = label.shape
    counts[:] = 0
    for row in range(height):
        for col in range(width):
            owner[row, col] = -1
            if label[row, col] < 0:
                continue
            p, best = points[row, col], np.inf
            for k in range(len(pixels)):
                i, j = pixels[k]
                reach = radius if label[i, j] == label[row, col] else near
                away = np.hypot(p[0] - axes[k, 0], p[1] - axes[k, 1])
                if away < reach and away < best and p[2] < points[i, j, 2] + _UNEVEN:
                    best = away
                    owner[row, col] = k
            if owner[row, col] >= 0:
                counts[owner[row, col]] += 1
