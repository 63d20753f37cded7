"""Whether memory and time stay where they are over a long run."""

import ctypes
import gc
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

MOST_GROWTH = 0.05
"""Share by which memory or time may grow after the first tenth of a run: what the allocator and the clock scatter."""


@dataclass(frozen=True, kw_only=True)
class Row:
    """One stretch of a long run.

    Attributes:
        memory_mb: Memory that the process held at its end, garbage collected [MB].
        step_ms: Mean time of processor for a step or a scan of it, all threads together [ms].
        reference_ms: Mean time of processor of the same fixed work, done between these steps [ms].
        done: Steps or scans since the start.
    """

    memory_mb: float
    step_ms: float
    reference_ms: float
    done: int


class Pace:
    """How fast the machine is just now, by a fixed piece of work.

    The pace of a shared machine changes by a third within minutes, which no run of hours escapes; what a step costs is
    therefore compared with what this work costs in between.
    """

    def __init__(self) -> None:
        self._values = np.sin(np.arange(4000.0))
        self._took, self._times = 0.0, 0

    def sample(self) -> None:
        """Do the work once, about a millisecond."""
        start = time.process_time()
        total = 0.0
        for value in range(8000):
            total += value
        for _ in range(4):
            np.cumsum(np.sort(self._values))
        self._took += time.process_time() - start
        self._times += 1

    def read(self) -> float:
        """Return the mean time of the samples since the last reading [ms]; there must be one."""
        mean = 1e3 * self._took / self._times
        self._took, self._times = 0.0, 0
        return mean


@dataclass(frozen=True, kw_only=True)
class Trend:
    """How memory and time went.

    Attributes:
        settled_mb: Median memory of the rows of the tenth after the first [MB].
        later_mb: The largest such median of a later tenth [MB]: what one row holds depends on its building.
        largest_mb: The most that was held at the end of any row after the first tenth [MB].
        settled_ms: Median time of a step in the tenth after the first, at the median pace of the whole run [ms].
        last_ms: The same in the last tenth [ms].
        bytes_a_step: By how much memory grew with each step or scan after the first tenth: the slope of a line.
    """

    settled_mb: float
    later_mb: float
    largest_mb: float
    settled_ms: float
    last_ms: float
    bytes_a_step: float

    @property
    def memory_growth(self) -> float:
        """Share by which memory grew after the first tenth."""
        return self.later_mb / self.settled_mb - 1.0

    @property
    def time_growth(self) -> float:
        """Share by which the time of a step grew after the first tenth."""
        return self.last_ms / self.settled_ms - 1.0

    @property
    def flat(self) -> bool:
        """Whether neither grew by more than `MOST_GROWTH`."""
        return max(self.memory_growth, self.time_growth) <= MOST_GROWTH


def trend(rows: Sequence[Mapping[str, float]]) -> Trend:
    """Return the trend of at least two rows, each with the fields of `Row`; the first tenth, rounded up, warms up."""
    names = ("memory_mb", "step_ms", "reference_ms", "done")
    memory, times, reference, done = (np.array([row[name] for row in rows]) for name in names)
    times = times * np.median(reference) / reference
    tenth = -(-len(rows) // 10)
    later = slice(tenth, None)
    slope = np.polyfit(done[later], memory[later], 1)[0] if len(done[later]) > 1 else 0.0
    return Trend(
        settled_mb=float(np.median(memory[tenth : 2 * tenth])),
        later_mb=max(float(np.median(part)) for part in np.split(memory, range(tenth, len(memory), tenth))[1:]),
        largest_mb=float(memory[later].max()),
        settled_ms=float(np.median(times[tenth : 2 * tenth])),
        last_ms=float(np.median(times[-tenth:])),
        bytes_a_step=1e6 * float(slope),
    )


def give_back_memory() -> None:
    """Give back what this process has freed but keeps for later, so that what it takes next is seen; where libc can."""
    gc.collect()
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None) if sys.platform == "linux" else None
    if trim is not None:
        trim(0)
