"""A scan as a chain of points with normals, the form in which the iterative matchers hold their reference."""

from dataclasses import dataclass, replace

import numba
import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..scan import LaserScan

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

    neighbours: int = 6
    tolerance: float = 0.015
    gap: float = 0.05
    obliquity: float = 6.0
    range_limit: float = 30.0
    even: bool = False

    def __post_init__(self) -> None:
        if not (self.neighbours >= 1 and min(self.tolerance, self.gap, self.obliquity, self.range_limit) > 0.0):
            raise InputError(f"all fields of SurfaceConfig must be positive, got {self}")


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


def relined(surfaces: Surfaces, config: SurfaceConfig) -> Surfaces:
    """Return the same points on the same surfaces, other lines fitted to them (`neighbours`, `tolerance`, `even`)."""
    lines = fit_lines(surfaces.points, surfaces.linked, config.neighbours, config.tolerance, config.even)
    return replace(surfaces, feet=lines[0], normals=lines[1], tilt_variance=lines[2])


@numba.njit(cache=True, nogil=True)
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


def noise_of(surfaces: Surfaces) -> float:
    """Return the standard deviation of a scan's points from straight lines [m], 0 where there are too few of them.

    From the distance of each point from the line of its two neighbours, by their median: corners do not count.
    """
    middle = np.flatnonzero(surfaces.linked[:-2] & surfaces.linked[1:-1]) + 1
    if len(middle) < 5:
        return 0.0
    chord = surfaces.points[middle + 1] - surfaces.points[middle - 1]
    aside = surfaces.points[middle] - surfaces.points[middle - 1]
    errors = np.abs(chord[:, 0] * aside[:, 1] - chord[:, 1] * aside[:, 0]) / np.maximum(np.hypot(*chord.T), 1e-9)
    # 0.6745: from the median to the deviation of a Gaussian; 1.5: the variance of the three points together.
    return float(np.median(errors) / (0.6745 * np.sqrt(1.5)))


@numba.njit(cache=True, nogil=True)
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


@numba.njit(cache=True, nogil=True)
def fit_lines(points, linked, neighbours, tolerance, even):  # pragma: no cover
    """Return feet (M, 2), normals (M, 2) and tilt variances (M,) of the lines through each point's neighbourhood."""
    count = len(points)
    feet, normals, tilt = points.copy(), np.zeros((count, 2)), np.full(count, np.inf)
    for m in range(count):
        for most in range(neighbours, 0, -1):
            behind, ahead = reach_along(linked, m, -1, most), reach_along(linked, m, 1, most)
            if even:
                behind = ahead = min(behind, ahead)
            size = min(1 + behind + ahead, count)
            if size < 2:
                break
            mx, my, sxx, sxy, syy = moments(points, m - behind, size)
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


@numba.njit(cache=True, nogil=True)
def reach_along(linked, m, direction, most):  # pragma: no cover
    """Return over how many links, at most `most`, the surface goes on from point m."""
    count = len(linked)
    for step in range(most):
        link = (m + step) % count if direction > 0 else (m - step - 1) % count
        if not linked[link]:
            return step
    return most


@numba.njit(cache=True, nogil=True)
def moments(points, start, size):  # pragma: no cover
    """Return mean x, y and the sums of squares about it (xx, xy, yy) of `size` points from `start`, cyclic."""
    count = len(points)
    mx, my, sxx, sxy, syy = 0.0, 0.0, 0.0, 0.0, 0.0
    for step in range(size):
        index = (start + step) % count
        mx += points[index, 0] / size
        my += points[index, 1] / size
    for step in range(size):
        index = (start + step) % count
        dx, dy = points[index, 0] - mx, points[index, 1] - my
        sxx += dx * dx
        sxy += dx * dy
        syy += dy * dy
    return mx, my, sxx, sxy, syy
