"""A people filter for scans whose stamps, odometry and order of beams are what logs have."""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from ...slam.scan import LaserScan
from ..hindsight import LAG_S, HindsightFilter
from ..people_filter import FilteredScan, PeopleFilter, PeopleFilterConfig

Beside = TypeVar("Beside")


@dataclass(eq=False)
class FilterCounts:
    """What was filtered.

    Attributes:
        scans: Number of scans.
        returns: Of all of them.
        removed: Those that were near people.
        people: Numbers of the people.
        progress: Called after each scan.
    """

    scans: int = 0
    returns: int = 0
    removed: int = 0
    people: set[int] = field(default_factory=set)
    progress: Callable[[], object] = int

    def add(self, filtered: FilteredScan) -> None:
        """Count one scan."""
        self.scans += 1
        self.returns += int(np.count_nonzero(filtered.scan.is_return))
        self.removed += int(np.count_nonzero(filtered.scan.is_return & filtered.removed))
        self.people.update(filtered.people.ids.tolist())
        self.progress()


class ScanFilter:
    """Takes people out of the scans of one laser, whatever their stamps.

    Args:
        config: Of the people filter.
    """

    def __init__(self, config: PeopleFilterConfig) -> None:
        self._filter = PeopleFilter(config)
        self._clock = IncreasingClock(config.tracker.motion.reference_rate_hz)

    def update(self, scan: LaserScan, odometry: NDArray[np.float64] | None) -> FilteredScan:
        """Take the next scan, with T_odom_robot (3,) or None, where there is no odometry."""
        return self._filter.update(replace(scan, time_s=self._clock.update(scan.time_s)), odometry)


class LateScanFilter(Generic[Beside]):
    """The same with hindsight, for recordings: a scan comes out some time later, with what was handed in beside it.

    Args:
        config: Of the people filter.
        lag_s: How much later [s].
    """

    def __init__(self, config: PeopleFilterConfig, lag_s: float = LAG_S) -> None:
        self._filter = HindsightFilter(config, lag_s=lag_s)
        self._clock = IncreasingClock(config.tracker.motion.reference_rate_hz)
        self._beside: deque[Beside] = deque()

    def take(
        self, scan: LaserScan, odometry: NDArray[np.float64] | None, beside: Beside
    ) -> list[tuple[Beside, FilteredScan]]:
        """Take the next scan, as `ScanFilter.update`; return those that are due."""
        self._beside.append(beside)
        timed = replace(scan, time_s=self._clock.update(scan.time_s))
        return [(self._beside.popleft(), filtered) for filtered in self._filter.update(timed, odometry)]

    def rest(self) -> list[tuple[Beside, FilteredScan]]:
        """Return the scans that still wait."""
        return [(self._beside.popleft(), filtered) for filtered in self._filter.finish()]


class IncreasingClock:
    """Turns stamps into times that increase: a step that does not is taken to be as long as the one before.

    Args:
        rate_hz: Of the stamps, until two are known [1/s].
    """

    def __init__(self, rate_hz: float) -> None:
        self._step_s, self._stamp_s, self._time_s = 1.0 / rate_hz, -np.inf, 0.0

    def update(self, stamp_s: float) -> float:
        """Return the time [s] of the next scan, whose stamp is `stamp_s` [s]."""
        if self._stamp_s == -np.inf:
            self._time_s = stamp_s
        else:
            self._step_s = stamp_s - self._stamp_s if stamp_s > self._stamp_s else self._step_s
            self._time_s += self._step_s
        self._stamp_s = stamp_s
        return self._time_s


def removed_readings(filtered: FilteredScan, order: NDArray[np.intp], readings: int, step: float) -> NDArray[np.bool_]:
    """Return (n,) which readings of a message are removed.

    Args:
        filtered: The scan that the message says.
        order: (N,) which reading each of its beams is. One that is none goes in the direction of another one, a full
            circle away, and is removed with it.
        readings: Number of readings n.
        step: Angle between two of them [rad]; infinite where a single beam does not tell it.
    """
    removed = np.zeros(readings, dtype=np.bool_)
    removed[order] = filtered.removed
    if len(order) < readings:
        again = np.setdiff1d(np.arange(readings), order)
        circle = round(2.0 * np.pi / abs(step))
        twin = np.where(again >= circle, again - circle, again + circle)
        there = twin < readings  # a beam that was left out for another reason has none
        removed[again[there]] = removed[twin[there]]
    return removed
