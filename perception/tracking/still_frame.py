"""How far the odometry frame stands still: only then does memory of places in it tell people from things.

In a frame that stands still, a wall is met again where it was. How often it is, is measured from scan to scan; nothing
is matched and nothing is assumed of the odometry. So a look back tells a walker from a thing under good odometry, and
tells nothing where the odometry is wrong or missing, or where there is nothing but grass, another one in every scan.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...slam.bounds import check_numbers, check_positive
from ...slam.view_kernel import kernel
from ..legs.clusters import Clusters
from ..legs.features import is_wide

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class StillFrameConfig:
    """How the frame is judged.

    Attributes:
        points: So many returns of a scan are asked for, evenly.
        memory_s: Time constant over which scans are judged together: a turn in which the odometry slips lasts about as
            long [s].
        doubt: Returns that must be asked before they count as much as not knowing does.
    """

    points: int = 50
    memory_s: float = 1.0
    doubt: float = 10.0

    def __post_init__(self) -> None:
        check_numbers(self)
        check_positive(self, "points", "memory_s", "doubt")


class StillFrame:
    """Judges one frame, scan by scan, by what is too wide to be anybody.

    Args:
        config: How.
    """

    def __init__(self, config: StillFrameConfig) -> None:
        self.config = config
        self.reset()

    def reset(self) -> None:
        """Forget everything: nothing is known of the frame."""
        self._asked, self._missed = 0.0, 0.0

    def update(self, shares: Array, dt: float) -> None:
        """Take the `shares` (n, 2) of recent scans in which the places of walls were empty, and occupied.

        The frame is common to all of them, so the middle one tells of it; glass, doors and who stands before a wall are
        outliers.
        """
        kept = float(np.exp(-dt / self.config.memory_s))
        count, middle = middle_miss(shares)
        self._asked, self._missed = kept * self._asked + count, kept * self._missed + count * middle

    @property
    def known(self) -> float:
        """How far the frame stands still, in [0, 1].

        1 where a wall is met again three times in four: people and glass hide the rest. 0 where as often as not, or
        where no wall has been seen yet.
        """
        doubt = self.config.doubt
        missed = (self._missed + 0.5 * doubt) / (self._asked + doubt)
        return float(np.clip(2.0 - 4.0 * missed, 0.0, 1.0))

    def walls(self, clusters: Clusters) -> Array:
        """Return (n, 2) some of the returns on clusters too wide to be anybody, in the laser frame [m]."""
        points = points_of(clusters.points, clusters.start, clusters.end, is_wide(clusters))
        return points[:: max(1, len(points) // self.config.points)]


@kernel
def middle_miss(shares):
    """Return how many of the places with `shares` (n, 2) tell, and the median of how often these were empty."""
    missed = np.empty(len(shares))
    count = 0
    for i in range(len(shares)):
        told = shares[i, 0] + shares[i, 1]
        if told > 0.0:
            missed[count] = shares[i, 0] / told
            count += 1
    return count, (np.median(missed[:count]) if count else 0.0)


@kernel
def points_of(points, start, end, chosen):
    """Return (j, 2) those of `points` (k, 2) in the `chosen` (m,) of the clusters from `start` (m,) to `end` (m,)."""
    kept = np.empty_like(points)
    count = 0
    for c in range(len(start)):
        if chosen[c]:
            for i in range(start[c], end[c]):
                kept[count] = points[i]
                count += 1
    return kept[:count]
