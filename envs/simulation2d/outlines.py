"""Flat outlines at the height of the laser: ellipses and segments, and the rays that meet them."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...slam.view_kernel import ieee_kernel

STATIC, LEG = 0, 1


@dataclass
class Outlines:
    """What the laser can meet, built up piece by piece.

    Attributes:
        ellipses: Rows (x, y, semi-axis along, semi-axis across, heading, kind, share of beams lost) [m, rad].
        segments: Rows (x1, y1, x2, y2, kind, share of beams lost) [m].
    """

    ellipses: list[tuple[float, ...]] = field(default_factory=list)
    segments: list[tuple[float, ...]] = field(default_factory=list)

    def ellipse(
        self,
        place: NDArray[np.float64],
        a: float,
        b: float,
        heading: float = 0.0,
        kind: int = STATIC,
        lost: float = 0.0,
    ) -> None:
        """Add an ellipse around `place` (2,)."""
        self.ellipses.append((*place, a, b, heading, kind, lost))

    def segment(self, start: NDArray[np.float64], end: NDArray[np.float64], lost: float = 0.0) -> None:
        """Add a thin wall from `start` to `end` (2,)."""
        self.segments.append((*start, *end, STATIC, lost))

    def polygon(self, corners: NDArray[np.float64], lost: float = 0.0, closed: bool = True) -> None:
        """Add the sides of a polygon with `corners` (n, 2)."""
        for i in range(len(corners) - (not closed)):
            self.segment(corners[i], corners[(i + 1) % len(corners)], lost)

    def box(self, place: NDArray[np.float64], length: float, width: float, heading: float, lost: float = 0.0) -> None:
        """Add a rectangle around `place` (2,)."""
        signs = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) * 0.5
        self.polygon(place + turned(signs * (length, width), heading), lost)

    def add(self, other: "Outlines") -> "Outlines":
        """Return the outlines of both."""
        return Outlines(self.ellipses + other.ellipses, self.segments + other.segments)

    def arrays(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the ellipses (n, 7) and the segments (m, 6)."""
        return np.array(self.ellipses).reshape(-1, 7), np.array(self.segments).reshape(-1, 6)


def turned(points: NDArray[np.float64], heading: float) -> NDArray[np.float64]:
    """Return `points` (n, 2) turned counter-clockwise by `heading`."""
    c, s = np.cos(heading), np.sin(heading)
    return points @ np.array([[c, s], [-s, c]])


@ieee_kernel
def cast(origins, angles, limit, ellipses, segments):
    """Cast rays from `origins` (n, 2) along `angles` (n,): the ranges (inf beyond `limit`) and what they meet first.

    What they meet is the row of `ellipses`, or the number of ellipses plus the row of `segments`; -1 for nothing.
    """
    count = len(angles)
    ranges = np.full(count, np.inf)
    met = np.full(count, -1)
    for i in range(count):
        x, y = origins[i]
        dx, dy = np.cos(angles[i]), np.sin(angles[i])
        best = limit
        for k in range(len(ellipses)):
            t = meet_ellipse(x, y, dx, dy, ellipses[k])
            if t < best:
                best = ranges[i] = t
                met[i] = k
        for k in range(len(segments)):
            t = meet_segment(x, y, dx, dy, segments[k])
            if t < best:
                best = ranges[i] = t
                met[i] = len(ellipses) + k
    return ranges, met


@ieee_kernel
def meet_segment(x, y, dx, dy, segment):
    """Return how far from (x, y) a ray along the unit vector (dx, dy) meets a row of segments, inf if nowhere."""
    ex, ey = segment[2] - segment[0], segment[3] - segment[1]
    px, py = segment[0] - x, segment[1] - y
    cross = dx * ey - dy * ex
    if cross == 0.0:
        return np.inf
    along = (px * dy - py * dx) / cross
    t = (px * ey - py * ex) / cross
    return t if t > 0.0 and 0.0 <= along <= 1.0 else np.inf


@ieee_kernel
def meet_ellipse(x, y, dx, dy, ellipse):
    """Return how far from (x, y) a ray along the unit vector (dx, dy) meets a row of ellipses, inf if nowhere."""
    px, py = x - ellipse[0], y - ellipse[1]
    reach = max(ellipse[2], ellipse[3])
    if abs(px * dy - py * dx) > reach:
        return np.inf
    c, s = np.cos(ellipse[4]), np.sin(ellipse[4])
    u, v = (c * px + s * py) / ellipse[2], (c * py - s * px) / ellipse[3]
    du, dv = (c * dx + s * dy) / ellipse[2], (c * dy - s * dx) / ellipse[3]
    a, b, e = du * du + dv * dv, u * du + v * dv, u * u + v * v - 1.0
    root = b * b - a * e
    if root < 0.0:
        return np.inf
    t = (-b - np.sqrt(root)) / a
    return t if t > 0.0 else np.inf
