"""The poses where a scan fits best on walls, wherever the robot may have gone since its place was known."""

import math

import numpy as np
from numpy.typing import NDArray

from ..search.branch_and_bound import SearchWindow, Separation, branch_and_bound
from ..search.score_pyramid import ScoreGrid, build_pyramid
from .sharp_sums import SHARP

Array = NDArray[np.float64]

_PLACES = 4  # a scan that fits in more has many, as along a corridor, and which it is, is not for a scan to tell
_LEAST_SHARE = 0.5  # of the best score: no motion is so likely that a place which scores less stands for it


def search_widely(
    field: NDArray[np.float32],
    corner: Array,
    resolution: float,
    points: Array,
    centre: Array,
    linear: float,
    angular: float,
    step: float,
    least: float,
) -> list[Array]:
    """Return the poses (3,) of a window at which the most points fall on walls, the best first.

    Args:
        field: (rows, cols) occupancy in [0, 1].
        corner: (2,) centre of its cell [0, 0] [m].
        resolution: Side of a cell [m].
        points: (N, 2) robot frame [m].
        centre: (3,) of the window.
        linear: Half the side of the window [m].
        angular: Half the range of headings [rad].
        step: Between headings [rad].
        least: Share of the points that must fall on walls.
    """
    x, y = (corner - 0.5 * resolution).tolist()
    grid = ScoreGrid.from_likelihood(np.minimum(SHARP * field, 1.0), (x, y), resolution)
    pyramid = build_pyramid(grid, margin=math.ceil(linear / resolution) + 1)
    window = SearchWindow(linear=linear, angular=angular, angular_step=step)
    apart = Separation(least_share=_LEAST_SHARE)
    found = branch_and_bound(pyramid, points, centre, window, min_score=least, maxima=_PLACES, separation=apart)
    return [np.array(place.pose) for place in found.maxima]
