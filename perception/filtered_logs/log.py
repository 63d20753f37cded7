"""A recorded drive in, the same out without people: a CARMEN log or a ROS bag of any kind."""

import math
import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from ...slam.drives.scan_correction import surveyed_bag
from ...slam.errors import InputError
from ...slam.files.input import checked_name, named
from ...slam.logs.bag_messages import is_bag
from ...slam.logs.carmen_copy import LaserLine, copy_carmen
from ...slam.logs.scan_stream import StreamedScan, read_beginning
from ..hindsight import LAG_S
from ..people_filter import FilteredScan, PeopleFilterConfig
from .bag import filter_bag
from .scan_filter import FilterCounts, LateScanFilter, removed_readings


@dataclass(frozen=True, kw_only=True)
class Topics:
    """Topics of a bag; None: those that its types tell.

    Attributes:
        scans: Of the scans to be filtered, needed where there are several.
        odometry: Of the odometry, likewise.
        filtered: Of the filtered scans; None: that of the scans, and "_filtered".
    """

    scans: str | None = None
    odometry: str | None = None
    filtered: str | None = None


@dataclass(frozen=True, eq=False)
class FilteredLog:
    """What became of a log.

    Attributes:
        counts: Scans, returns, people.
        topic: Of the filtered scans; "" for a log without topics.
        notes: What was assumed, a sentence each.
    """

    counts: FilterCounts
    topic: str
    notes: tuple[str, ...] = ()


def filter_log(
    source: str | os.PathLike[str],
    target: str | os.PathLike[str],
    config: PeopleFilterConfig,
    topics: Topics | None = None,
    progress: Callable[[], object] = int,
    lag_s: float = LAG_S,
) -> FilteredLog:
    """Take people out of the scans of a recorded drive, scan by scan: memory does not grow with the drive.

    A CARMEN log has "no measurement" for the returns of people. A bag has topics added to it; see `filter_bag`. Nothing
    else changes. The target appears when it is complete.

    Args:
        source: CARMEN log (plain or gzipped), ROS 1 bag, MCAP file or folder of a ROS 2 bag.
        target: Where the copy goes.
        config: Of the people filter.
        topics: Of a bag.
        progress: Called after each scan.
        lag_s: How much later people are told of, see `HindsightFilter` [s].

    Raises:
        InputError: If source and target are one, or the target's name is that of another kind of log, the log cannot be
            read, or the target cannot be written.
        MissingExtraError: If it is a bag and the libraries for it are not installed.
    """
    if os.path.realpath(checked_name(source)) == os.path.realpath(checked_name(target)):
        raise InputError(f"{named(target)}: is the log itself; give another name")
    _require_name_of_its_kind(checked_name(source), checked_name(target))
    topics, counts = topics or Topics(), FilterCounts(progress=progress)
    if is_bag(source):
        bag, correction = surveyed_bag(read_beginning(source, topics.scans, topics.odometry))
        scans = LateScanFilter[StreamedScan](config, lag_s)
        return FilteredLog(counts, filter_bag(bag, target, scans, counts, topics.filtered, correction), bag.notes)
    if topics != Topics():
        raise InputError(f"{named(source)}: only a ROS bag has topics to choose")
    copy_carmen(source, target, _LineRemoval(config, counts, lag_s))
    return FilteredLog(counts, "")


_BAGS = {".bag": "a ROS 1 bag", ".mcap": "an MCAP file", ".db3": "a file in the folder of a ROS 2 bag"}


def _require_name_of_its_kind(source: Path, target: Path) -> None:
    """Refuse a name by which other programs would take the copy for what it is not: a copy is what its source is."""
    is_file = is_bag(source) and not source.is_dir()
    kind = (".mcap" if source.suffix == ".mcap" else ".bag") if is_file else ""
    if target.suffix in _BAGS and target.suffix != kind:
        found = _BAGS[kind] if is_file else "a folder" if source.is_dir() else "no bag"
        raise InputError(
            f"{named(target)}: is a name of {_BAGS[target.suffix]}, but {named(source)} is {found}, and so will its "
            f"copy be; give a name without {target.suffix}"
        )


_MOST_WAITING = 1000


class _LineRemoval:
    """What to take out of laser lines of a log, see `carmen_copy.Removal`; each kind of line is a laser of its own."""

    def __init__(self, config: PeopleFilterConfig, counts: FilterCounts, lag_s: float = LAG_S) -> None:
        self._config, self._counts, self._lag_s, self._lines = config, counts, lag_s, 0
        self._filters: dict[str, LateScanFilter[LaserLine]] = {}
        self._last: dict[str, int] = {}

    def take(self, line: LaserLine) -> None:
        """Filter a line's scan; tell the lines that are due what to take out of them."""
        if line.kind not in self._filters:
            self._filters[line.kind] = LateScanFilter(self._config, self._lag_s)
        self._lines += 1
        self._last[line.kind] = self._lines
        self._tell(self._filters[line.kind].take(line.scan, line.odometry, line))
        for kind, scans in self._filters.items():
            if self._lines - self._last[kind] == _MOST_WAITING:  # a laser that has fallen silent holds up all others
                self._tell(scans.rest())

    def rest(self) -> None:
        """Tell the lines that still wait."""
        for scans in self._filters.values():
            self._tell(scans.rest())

    def _tell(self, due: list[tuple[LaserLine, FilteredScan]]) -> None:
        for line, filtered in due:
            self._counts.add(filtered)
            bearings = line.scan.bearings
            step = float(bearings[1] - bearings[0]) if len(bearings) > 1 else math.inf
            line.removed = removed_readings(filtered, line.order, line.readings, step)
