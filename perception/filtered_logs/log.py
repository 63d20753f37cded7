"""A recorded drive in, the same out without people: a CARMEN log or a ROS bag of any kind."""

import math
import os
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...slam.drives.scan_correction import surveyed_bag
from ...slam.errors import InputError
from ...slam.files.input import checked_name, named
from ...slam.logs.bag_messages import is_bag
from ...slam.logs.carmen_copy import copy_carmen
from ...slam.logs.scan_stream import read_beginning
from ...slam.scan import LaserScan
from ..people_filter import PeopleFilterConfig
from .bag import filter_bag
from .scan_filter import FilterCounts, ScanFilter, removed_readings


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

    Raises:
        InputError: If source and target are one, the log cannot be read, or the target cannot be written.
        MissingExtraError: If it is a bag and the libraries for it are not installed.
    """
    if os.path.realpath(checked_name(source)) == os.path.realpath(checked_name(target)):
        raise InputError(f"{named(target)}: is the log itself; give another name")
    topics, counts = topics or Topics(), FilterCounts(progress=progress)
    if is_bag(source):
        bag, correction = surveyed_bag(read_beginning(source, topics.scans, topics.odometry))
        return FilteredLog(counts, filter_bag(bag, target, config, counts, topics.filtered, correction), bag.notes)
    if topics != Topics():
        raise InputError(f"{named(source)}: only a ROS bag has topics to choose")
    filters: dict[str, ScanFilter] = {}

    def removal(
        kind: str, scan: LaserScan, odometry: NDArray[np.float64], order: NDArray[np.intp], readings: int
    ) -> NDArray[np.bool_]:
        """Filter a scan; each kind of line is a laser of its own. See `Removal`."""
        if kind not in filters:
            filters[kind] = ScanFilter(config)
        filtered = filters[kind].update(scan, odometry)
        counts.add(filtered)
        step = float(scan.bearings[1] - scan.bearings[0]) if len(scan) > 1 else math.inf
        return removed_readings(filtered, order, readings, step)

    copy_carmen(source, target, removal)
    return FilteredLog(counts, "")
