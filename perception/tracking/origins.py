"""Whether what moved has left the place where it began."""

import numpy as np
from numpy.typing import NDArray

from .data_association import distances
from .local_grid import LocalGrid
from .tracks import Rows, Tracks


class OriginCheck:
    """Tells legs that walked from tracks that hopped from one thing to the next, e.g. from chair leg to chair leg.

    A track that hopped has moved, but what it began at still stands there. Where that is known to be no human, the
    track begins anew where it is now.

    Args:
        radius: Nothing may stand any more within this distance of where a track began [m].
        grid: Where things stand that are not human.
    """

    def __init__(self, radius: float, grid: LocalGrid) -> None:
        self._radius, self._grid = radius, grid

    def check(self, tracks: Tracks, rows: Rows, points: NDArray[np.float64], time_s: float) -> NDArray[np.bool_]:
        """Return (k,) whether none of the scan's `points` (n, 2), odometry frame, is where the tracks `rows` began."""
        first = tracks.legs.rows["first"][rows]
        left = distances(first, points).min(axis=1, initial=np.inf) > self._radius
        tracks.legs.restart_moving(rows[~left & ~self._grid.is_free(first, time_s)])
        return left
