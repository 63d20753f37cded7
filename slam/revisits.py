"""Views that were seen again so often that the oldest scans of them tell nothing new.

Maps are drawn from scans. Without a bound, laps of one building would keep scan upon scan of the same walls, in memory
and in time; here a scan is superseded once enough newer ones were taken from the same place in the same direction. The
newest stay, so that a map follows a building that changes (as Cartographer's trimmer of overlapping submaps does).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from .bounds import Within, check_numbers
from .scan import LaserScan

_FEWEST = 256  # scans are kept without a look at whether they are superseded
_GROWTH = 1.25  # so much more are kept before the next look: it then costs little for each


@dataclass(frozen=True, kw_only=True)
class RevisitConfig:
    """When a scan is superseded.

    Attributes:
        views: So many newer scans share its view. Where a cell's log-odds saturate after 6 hits and 13 misses, as in
            `GridConfig`, more of one view say nothing new. In none of nine logs of 0.2 to 2.5 km did a submap reach
            half of it, so that it changes no map of a building that is driven through a few times.
        distance: Two scans share a view within this distance [m] ...
        angle: ... and this angle [rad]; both count together, as the axes of an ellipsoid.
    """

    views: Annotated[int, Within(1, 1_000_000)] = 12
    distance: Annotated[float, Within(0.01, 100.0)] = 0.5
    angle: Annotated[float, Within(0.01, np.pi)] = 0.5

    def __post_init__(self) -> None:
        check_numbers(self)


def superseded(poses: NDArray[np.float64], config: RevisitConfig) -> NDArray[np.bool_]:
    """Return (n,) whether so many later ones of `poses` (n, 3) share the view of each that it tells nothing new."""
    lever = config.distance / (2.0 * np.sin(0.5 * config.angle))  # [m] whose end moves by `distance` in such a turn
    ends = lever * np.stack((np.cos(poses[:, 2]), np.sin(poses[:, 2])), axis=-1)
    pairs = KDTree(np.concatenate((poses[:, :2], ends), axis=1)).query_pairs(config.distance, output_type="ndarray")
    newer = np.bincount(pairs.min(axis=1), minlength=len(poses)) if len(pairs) else np.zeros(len(poses), dtype=np.int64)
    return np.asarray(newer >= config.views)


class KeptScans:
    """The scans that draw a map, without those that are superseded.

    Args:
        config: When a scan is superseded.

    Attributes:
        numbers: Which scan, or pose, each one is; ascending.
        scans: The scans.
    """

    def __init__(self, config: RevisitConfig | None = None) -> None:
        self._config = config or RevisitConfig()
        self.numbers: list[int] = []
        self.scans: list[LaserScan] = []
        self._due = _FEWEST

    def __len__(self) -> int:
        return len(self.scans)

    def append(self, number: int, scan: LaserScan) -> None:
        """Keep a scan."""
        self.numbers.append(number)
        self.scans.append(scan)

    @property
    def due(self) -> bool:
        """Whether it is time for `thin`."""
        return len(self.scans) >= self._due

    def thin(self, poses: Sequence[NDArray[np.float64]] | NDArray[np.float64]) -> None:
        """Drop the scans that are superseded; `poses` (n, 3) says where each was taken."""
        kept = np.flatnonzero(~superseded(np.asarray(poses), self._config)).tolist()
        self.numbers, self.scans = [self.numbers[k] for k in kept], [self.scans[k] for k in kept]
        self._due = max(_FEWEST, int(_GROWTH * len(kept)))
