"""A scan as a chain of points with normals, the form in which the iterative matchers hold their reference."""

from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from ..bounds import Reach, Within, check_numbers
from ..errors import InputError
from ..scan import LaserScan
from ..view_kernel import kernel

BINS = 1024  # of the table that finds the first beam to look at


@dataclass(frozen=True, kw_only=True)
class SurfaceConfig:
    """How lines are fitted to the points of a scan.

    Attributes:
        neighbours: Most points to each side of a point that its line is fitted to.
        tolerance: A line is fitted to fewer points until their rms distance from it is at most this [m].
        gap: Points side by side are of one surface up to this distance [m] plus `obliquity` beam widths.
        obliquity: Beam widths (range times angle between the beams) between such points.
        range_limit: Returns beyond are left out [m].
        even: Lines reach equally far to both sides, so that the curve of a wall tilts no normal; a surface's last
            points have none.
    """

    neighbours: Annotated[int, Within(1, 1000)] = 6
    tolerance: float = 0.015
    gap: float = 0.05
    obliquity: float = 6.0
    range_limit: Reach = 30.0
    even: bool = False

    def __post_init__(self) -> None:
        check_numbers(self)
        if not (self.neighbours >= 1 and min(self.tolerance, self.gap, self.obliquity, self.range_limit) > 0.0):
            raise InputError(f"all fields of SurfaceConfig must be positive, got {self}")


LOOSE = SurfaceConfig()
"""Links that noise does not break."""


@dataclass(frozen=True, eq=False)
class Surfaces:
    """The returns of a scan, counter-clockwise, with the line through each and its neighbours.

    Attributes:
        points: (M, 2) returns in the laser frame [m].
        rays: (M, 2) unit vectors from the laser to them.
        feet: (M, 2) the points moved onto their lines [m].
        normals: (M, 2) unit normals of the lines; zeros where a point has no neighbour.
        tilt_variance: (M,) variance of the normal's direction for a noise of 1 m [rad^2/m^2].
        linked: (M,) whether the next point (of the last: the first) lies on the same surface.
        first: (BINS,) int32 index of the first point counter-clockwise of each bin of bearings from -pi.
    """

    points: NDArray[np.float64]
    rays: NDArray[np.float64]
    feet: NDArray[np.float64]
    normals: NDArray[np.float64]
    tilt_variance: NDArray[np.float64]
    linked: NDArray[np.bool_]
    first: NDArray[np.int32]

    def __len__(self) -> int:
        return len(self.points)

    @property
    def arrays(self) -> tuple[NDArray, NDArray, NDArray, NDArray, NDArray, NDArray]:
        """(points, rays, feet, normals, linked, first), as the kernels take them."""
        return self.points, self.rays, self.feet, self.normals, self.linked, self.first


def near_points(scan: LaserScan, range_limit: float) -> NDArray[np.float64]:
    """Return (M, 2) the returns of a scan nearer than `range_limit` [m], in the laser frame, in beam order."""
    keep = scan.is_return & (scan.ranges <= range_limit) & (scan.ranges > 0.0)
    return np.ascontiguousarray(scan.beam_points[keep])


def find_surfaces(scan: LaserScan, config: SurfaceConfig) -> Surfaces:
    """Return the points of a scan with lines fitted to them; a scan without returns gives empty arrays."""
    keep = np.flatnonzero(scan.is_return & (scan.ranges <= config.range_limit) & (scan.ranges > 0.0))
    bearings = (scan.bearings[keep] + np.pi) % (2.0 * np.pi) - np.pi
    if len(keep) and np.any(bearings[1:] < bearings[:-1]):
        order = np.argsort(bearings, kind="stable")
        keep, bearings = keep[order], bearings[order]
    ranges = scan.ranges[keep]
    rays = np.empty((len(keep), 2))
    rays[:, 0], rays[:, 1] = np.cos(bearings), np.sin(bearings)
    points = rays * ranges[:, None]
    linked = link_points(points, ranges, bearings, config.gap, config.obliquity)
    feet, normals, tilt_variance = fit_lines(points, linked, config.neighbours, config.tolerance, config.even)
    return Surfaces(points, rays, feet, normals, tilt_variance, linked, first_points(bearings))


def every_second(surfaces: Surfaces, side: int, config: SurfaceConfig) -> Surfaces:
    """Return the surfaces of every second point, from the first (`side` 0) or the second (1)."""
    points, rays = surfaces.points[side::2].copy(), surfaces.rays[side::2].copy()
    ranges, bearings = (points * rays).sum(axis=1), np.arctan2(rays[:, 1], rays[:, 0])
    linked = link_points(points, ranges, bearings, config.gap, config.obliquity)
    feet, normals, tilt_variance = fit_lines(points, linked, config.neighbours, config.tolerance, config.even)
    return Surfaces(points, rays, feet, normals, tilt_variance, linked, first_points(bearings))


def relined(surfaces: Surfaces, config: SurfaceConfig) -> Surfaces:
    """Return the same points on the same surfaces, other lines fitted to them (`neighbours`, `tolerance`, `even`)."""
    lines = fit_lines(surfaces.points, surfaces.linked, config.neighbours, config.tolerance, config.even)
    return replace(surfaces, feet=lines[0], normals=lines[1], tilt_variance=lines[2])


@kernel
def first_points(bearings):  # pragma: no cover
    """Return (BINS,) int32: how many of the ascending `bearings` lie below the lower edge of each bin from -pi."""
    first = np.empty(BINS, dtype=np.int32)
    below = 0
    for b in range(BINS):
        edge = -np.pi + b * (2.0 * np.pi / BINS)
        while below < len(bearings) and bearings[below] < edge:
            below += 1
        first[b] = below
    return first


def noise_of(surfaces: Surfaces, links: SurfaceConfig = LOOSE) -> float:
    """Return the standard deviation of a scan's points from straight lines [m], 0 where there are too few of them.

    From the distance of each point from the line of its two neighbours, by the lowest quarter of them: neither corners
    nor leaves and chair legs count, as long as a part of what the laser sees is smooth. `links` say which points are
    neighbours; strict ones would leave out what noise puts apart.
    """
    errors = bend(surfaces.points, surfaces.rays, links.gap, links.obliquity)
    if len(errors) < 5:
        return 0.0
    # 0.3186: from the quarter to the deviation of a Gaussian; 1.5: the variance of the three points together.
    return lower_quartile(errors) / (0.3186 * np.sqrt(1.5))


@kernel
def bend(points, rays, gap, obliquity):  # pragma: no cover
    """Return the distance [m] of each point from the line of its two neighbours, where all are of one surface."""
    count = len(points)
    ranges, bearings, errors = np.empty(count), np.empty(count), np.empty(count)
    for m in range(count):
        ranges[m] = points[m, 0] * rays[m, 0] + points[m, 1] * rays[m, 1]
        bearings[m] = np.arctan2(rays[m, 1], rays[m, 0])
    linked, found = link_points(points, ranges, bearings, gap, obliquity), 0
    for m in range(1, count - 1):
        if linked[m - 1] and linked[m]:
            cx, cy = points[m + 1, 0] - points[m - 1, 0], points[m + 1, 1] - points[m - 1, 1]
            ax, ay = points[m, 0] - points[m - 1, 0], points[m, 1] - points[m - 1, 1]
            errors[found] = abs(cx * ay - cy * ax) / max(np.sqrt(cx * cx + cy * cy), 1e-9)
            found += 1
    return errors[:found]


@kernel
def lower_quartile(values):  # pragma: no cover
    """Return the linearly interpolated 25 % point of `values`, of which there is one at least."""
    place = 0.25 * (len(values) - 1)
    below = int(place)
    ordered = np.sort(values)
    return ordered[below] + (place - below) * (ordered[min(below + 1, len(values) - 1)] - ordered[below])


@kernel
def link_points(points, ranges, bearings, gap, obliquity):  # pragma: no cover
    """Return (M,) whether each point and the next lie on one surface."""
    count = len(points)
    linked = np.zeros(count, dtype=np.bool_)
    if count < 3:
        return linked
    for m in range(count):
        after = m + 1 if m + 1 < count else 0
        angle = bearings[after] - bearings[m]
        if angle < 0.0:
            angle += 2.0 * np.pi
        # Beyond ten degrees there are no beams between the two; they say nothing about each other.
        limit = gap + obliquity * min(ranges[m], ranges[after]) * angle
        dx, dy = points[after, 0] - points[m, 0], points[after, 1] - points[m, 1]
        linked[m] = angle < 0.18 and dx * dx + dy * dy < limit * limit
    return linked


@kernel
def fit_lines(points, linked, neighbours, tolerance, even):  # pragma: no cover
    """Return feet (M, 2), normals (M, 2) and tilt variances (M,) of the lines through each point's neighbourhood."""
    count = len(points)
    feet, normals, tilt = points.copy(), np.zeros((count, 2)), np.full(count, np.inf)
    sums = running_sums(points)
    for m in range(count):
        farthest = reach_along(linked, m, -1, neighbours), reach_along(linked, m, 1, neighbours)
        for most in range(neighbours, 0, -1):
            behind, ahead = min(farthest[0], most), min(farthest[1], most)
            if even:
                behind = ahead = min(behind, ahead)
            size = min(1 + behind + ahead, count)
            if size < 2:
                break
            mx, my, sxx, sxy, syy = moments(sums, (m - behind) % count, size)
            half, root = 0.5 * (sxx + syy), np.sqrt(0.25 * (sxx - syy) ** 2 + sxy * sxy)
            if max(half - root, 0.0) <= tolerance * tolerance * size or (most == 1 and size == 2):
                angle = 0.5 * np.arctan2(2.0 * sxy, sxx - syy)
                nx, ny = -np.sin(angle), np.cos(angle)
                off = nx * (points[m, 0] - mx) + ny * (points[m, 1] - my)
                feet[m, 0], feet[m, 1] = points[m, 0] - off * nx, points[m, 1] - off * ny
                normals[m, 0], normals[m, 1] = nx, ny
                tilt[m] = 1.0 / max(half + root, 1e-9)
                break
    return feet, normals, tilt


@kernel
def reach_along(linked, m, direction, most):  # pragma: no cover
    """Return over how many links, at most `most`, the surface goes on from point m."""
    count = len(linked)
    for step in range(most):
        link = (m + step) % count if direction > 0 else (m - step - 1) % count
        if not linked[link]:
            return step
    return most


@kernel
def running_sums(points):  # pragma: no cover
    """Return (2 M + 1, 5): the sums of x, y, xx, xy, yy over all points before each, the scan taken twice in a row."""
    count = len(points)
    sums = np.zeros((2 * count + 1, 5))
    for m in range(2 * count):
        x, y = points[m % count, 0], points[m % count, 1]
        sums[m + 1, 0] = sums[m, 0] + x
        sums[m + 1, 1] = sums[m, 1] + y
        sums[m + 1, 2] = sums[m, 2] + x * x
        sums[m + 1, 3] = sums[m, 3] + x * y
        sums[m + 1, 4] = sums[m, 4] + y * y
    return sums


@kernel
def moments(sums, start, size):  # pragma: no cover
    """Return mean x, y and the sums of squares about it (xx, xy, yy) of `size` points from `start`, cyclic."""
    end = start + size
    x, y = sums[end, 0] - sums[start, 0], sums[end, 1] - sums[start, 1]
    mx, my = x / size, y / size
    xx, xy, yy = sums[end, 2] - sums[start, 2], sums[end, 3] - sums[start, 3], sums[end, 4] - sums[start, 4]
    return mx, my, max(xx - mx * x, 0.0), xy - mx * y, max(yy - my * y, 0.0)
