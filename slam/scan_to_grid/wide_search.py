"""The pose where a scan fits best on walls, wherever the robot may have gone since its place was known."""

import math

import numpy as np
from numpy.typing import NDArray

from ..search.branch_and_bound import SearchWindow, Separation, branch_and_bound
from ..search.score_pyramid import ScoreGrid, build_pyramid
from .sharp_sums import SHARP

Array = NDArray[np.float64]

_ALIKE = 0.9  # another place that scores so much of the best looks alike: in corridors, where all places do


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
) -> Array | None:
    """Return the pose (3,) of a window at which the most points fall on walls; None: too few do, or as many elsewhere.

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
    apart = Separation(least_share=_ALIKE)
    found = branch_and_bound(pyramid, points, centre, window, min_score=least, maxima=2, separation=apart).maxima
    return np.array(found[0].pose) if len(found) == 1 else None
