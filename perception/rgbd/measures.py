"""What a candidate is like apart from its picture: what bounds it, how large and how flat it is, where it stands.

A piece of wall between two people has the outline of somebody, but what is beside it is nearer; a lamp has a head, but
is thin; a banner is as large as somebody, but flat. Each measure is given in soft bins, so that a linear classifier may
like the middle of its range best.
"""

from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from ...slam.view_kernel import kernel
from .frame import RgbdFrame
from .heads import Candidates
from .margins import margins
from .planes import Planes, Surface

Array = NDArray[np.float64]


class Border(IntEnum):
    """What lies beyond the edge of a candidate, seen from the camera."""

    FREE = 0
    HIDDEN = 1
    TOUCHING = 2
    UNMEASURED = 3
    CUT = 4


BORDER_STEP = 0.15
"""What lies beyond is farther or nearer if it differs by this in depth [m]."""
_REACH = 4
_SHARES = (0.0, 0.05, 0.15, 0.35, 0.65, 1.0)
_KNOTS = np.array(
    [
        *[_SHARES] * (2 * len(Border)),
        (0.03, 0.08, 0.13, 0.18, 0.25, 0.35),  # spread sideways
        (0.01, 0.03, 0.06, 0.09, 0.13, 0.2),  # spread in depth
        (0.6, 0.95, 1.25, 1.5, 1.75, 2.05),  # highest point
        (0.0, 0.15, 0.4, 0.8, 1.1, 1.4),  # lowest point
        (0.6, 1.0, 1.5, 2.5, 4.0, 6.0),  # distance
        (0.02, 0.1, 0.2, 0.35, 0.55, 0.9),  # area in sight
        *[(0.0, 0.1, 0.3, 0.5, 0.7, 1.0)] * 3,  # on upright planes, on walls, on the largest plane
    ]
)
MEASURES = len(_KNOTS)
MEASURES_LENGTH = _KNOTS.size
"""How many numbers describe a candidate."""


def candidate_measures(planes: Planes, candidates: Candidates) -> Array:
    """Return (n, MEASURES) of the candidates.

    Shares of the edge at the sides that are `Border.FREE` and so on, the same of the upper edge; standard deviation of
    the points along the longer and the shorter axis of what is seen from above [m]; greatest and least height [m], of
    legs alone twice that, as in their windows;
    distance [m]; area across the line of sight [m2]; shares of the points on upright planes that are no walls, on
    walls, and on the plane that holds most of them.
    """
    frame, measures = planes.frame, np.empty((len(candidates), MEASURES))
    counts = np.zeros((len(candidates), 2, len(Border)))
    count_borders(frame.depth, candidates.label, BORDER_STEP, counts, *margins(frame.depth))
    shares = counts / np.maximum(counts.sum(axis=2, keepdims=True), 1.0)
    measures[:, : 2 * len(Border)] = shares.reshape(len(candidates), 2 * len(Border))
    for k in range(len(candidates)):
        mine = candidates.label == k
        scale = 2.0 if candidates.legs[k] else 1.0
        measures[k, 2 * len(Border) :] = *_extents(frame, planes.points[mine], mine, scale), *_flatness(planes, mine)
    return measures


def _flatness(planes: Planes, mine: NDArray[np.bool_]) -> tuple[float, float, float]:
    surface, region = planes.surface[mine], planes.region[mine]
    largest = np.bincount(region[region >= 0], minlength=1).max() / len(region)
    return float((surface == Surface.FACE).mean()), float((surface == Surface.WALL).mean()), float(largest)


def _extents(frame: RgbdFrame, of: Array, mine: NDArray[np.bool_], scale: float) -> tuple[float, ...]:
    least, most = np.linalg.eigvalsh(np.cov(of[:, :2].T, bias=True))
    across, down = frame.camera.focal
    area = float((frame.depth[mine] ** 2).sum() / (across * down))
    distance = float(np.hypot(*of[:, :2].mean(axis=0)))
    spread = float(np.sqrt(max(most, 0.0))), float(np.sqrt(max(least, 0.0)))
    return *spread, scale * float(of[:, 2].max()), scale * float(of[:, 2].min()), distance, area


def soft_bins(measures: Array) -> NDArray[np.float32]:
    """Return (n, MEASURES_LENGTH): each of `measures` (n, MEASURES) shared out between the two knots around it."""
    bins = np.zeros((len(measures), *_KNOTS.shape), dtype=np.float32)
    rows = np.arange(len(measures))
    for k, knots in enumerate(_KNOTS):
        place = np.interp(measures[:, k], knots, np.arange(len(knots)))
        lower = np.minimum(place.astype(int), len(knots) - 2)
        bins[rows, k, lower] = 1.0 - (place - lower)
        bins[rows, k, lower + 1] = place - lower
    return bins.reshape(len(measures), MEASURES_LENGTH)


@kernel
def count_borders(depth, label, step, counts, top, left, right):
    """Count what lies beyond the edges of each candidate: the first thing measured within a few pixels.

    Args:
        depth: (h, w) [m], NaN where nothing was measured.
        label: (h, w) candidate of each pixel, -1 for none.
        step: Least difference in depth of what is farther or nearer [m].
        counts: (n, 2, Border) of the sides, and of the upper edge; added to.
        top: First row of the picture in which depth is measured.
        left: First column.
        right: The column after the last one.
    """
    height, width = label.shape
    for row in range(height):
        for col in range(width):
            if label[row, col] >= 0:
                for side in range(-1, 2):
                    up = 1 if side == 0 else 0
                    border = _border(depth, label, row, col, -up, side, step, top, left, right)
                    if border >= 0:
                        counts[label[row, col], up, border] += 1.0


@kernel
def _border(depth, label, row, col, down, across, step, top, left, right):
    """Return the number of the `Border` at one side of a pixel, -1 if its own candidate goes on there."""
    for away in range(1, _REACH + 1):
        i, j = row + away * down, col + away * across
        if i < top or i >= label.shape[0] or j < left or j >= right:
            return 4
        if label[i, j] == label[row, col]:
            return -1
        if np.isfinite(depth[i, j]):
            beyond = depth[i, j] - depth[row, col]
            return 0 if beyond > step else 1 if beyond < -step else 2
    return 3
