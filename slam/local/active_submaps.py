"""The two submaps that grow at a time: the older one is matched against, the younger one will be next."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ..bounds import check_numbers
from ..errors import InputError
from .submap import Submap, SubmapConfig
from .sweep import Sweep

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class ActiveSubmapsConfig:
    """Settings of `ActiveSubmaps`: a submap is begun when the youngest one is full, so each gets twice as much.

    Attributes:
        submap: Settings of each submap.
        scans: The youngest submap is full with so many scans ...
        distance: ... or when the robot has travelled so far since it began [m] ...
        min_scans: ... but never with fewer scans than this.
    """

    submap: SubmapConfig = field(default_factory=SubmapConfig)
    scans: int = 40
    distance: float = 8.0
    min_scans: int = 8

    def __post_init__(self) -> None:
        check_numbers(self)
        if not 1 <= self.min_scans <= self.scans:
            raise InputError(f"need 1 <= `min_scans` <= `scans`, got {self.min_scans} and {self.scans}")
        if not self.distance > 0.0:
            raise InputError(f"`distance` must be positive [m], got {self.distance}")


class ActiveSubmaps:
    """Inserts every scan into the two active submaps and hands on finished ones.

    Args:
        config: Settings.

    Attributes:
        submaps: Every submap so far, in order; the last two (or the only one) are active.
        drawn: How often they have changed.
    """

    def __init__(self, config: ActiveSubmapsConfig) -> None:
        self._config = config
        self.submaps: list[Submap] = []
        self._first = 0  # of the submaps of this drive segment
        self._travelled = 0.0
        self._last: Array | None = None
        self.drawn = 0

    @property
    def front(self) -> Submap:
        """The submap that scans are matched against."""
        return self.submaps[max(len(self.submaps) - 2, self._first)]

    @property
    def begun(self) -> bool:
        """Whether there is a submap to match against."""
        return len(self.submaps) > self._first

    def restart(self) -> None:
        """Finish the active submaps: the next scan begins a new one, apart from all before."""
        for submap in self.submaps[self._first :][-2:]:
            submap.finish()
        self._first = len(self.submaps)
        self._last = None
        self.drawn += 1

    def trim(self, stay: NDArray[np.bool_]) -> None:
        """Drop the finished submaps where `stay` (one for each submap) is false."""
        self._first = int(stay[: self._first].sum())
        self.submaps[:] = [submap for submap, stays in zip(self.submaps, stay.tolist(), strict=True) if stays]

    def insert(self, pose: Array, sweep: Sweep) -> tuple[int, ...]:
        """Insert a scan at `pose` (3,) T_local_robot; return the indices of the submaps that it stands in.

        Args:
            pose: Where the robot was.
            sweep: What the scan draws, robot frame.
        """
        if self._last is not None:
            self._travelled += float(np.hypot(*(pose[:2] - self._last[:2])))
        self._last = pose
        if not self.begun or self._full(self.submaps[-1]):
            self.submaps.append(Submap(self._config.submap, pose))
            self._travelled = 0.0
            for submap in self.submaps[self._first : -2][-1:]:
                submap.finish()
        first, placed = max(len(self.submaps) - 2, self._first), sweep.at(pose)
        for submap in self.submaps[first:]:
            submap.insert(placed)
        self.drawn += 1
        return tuple(range(first, len(self.submaps)))

    def _full(self, youngest: Submap) -> bool:
        config = self._config
        if youngest.scans < config.min_scans:
            return False
        return youngest.scans >= config.scans or self._travelled >= config.distance
