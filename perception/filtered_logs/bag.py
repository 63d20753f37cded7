"""A ROS bag in, the same out with more topics: the scans without people, the people, their legs."""

import os
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...slam.drives.scan_correction import ScanCorrection
from ...slam.errors import InputError
from ...slam.files.input import named, naming
from ...slam.logs.bag_copy.copied import FileCopy, copied_bag
from ...slam.logs.rosbag import SCAN, first_echoes
from ...slam.logs.scan_stream import BagBeginning, ScanStream, StreamedScan
from ..people_filter import FilteredScan
from .people_messages import CLOUD, POSES, PeopleMessages
from .scan_filter import FilterCounts, LateScanFilter, removed_readings

_GEOMETRY = ("angle_min", "angle_max", "angle_increment", "time_increment", "scan_time", "range_min", "range_max")


def filter_bag(
    bag: BagBeginning,
    target: str | os.PathLike[str],
    scans: LateScanFilter[StreamedScan],
    counts: FilterCounts,
    topic: str | None = None,
    correction: ScanCorrection | None = None,
) -> str:
    """Copy a bag to `target`, and its scans without people: their returns become NaN (REP 117: no measurement).

    Added are TOPIC, the filtered scans; TOPIC/people and TOPIC/legs (`geometry_msgs/PoseArray`) and TOPIC/tracks
    (`sensor_msgs/PointCloud2`, with numbers, velocities and confidences), all with the headers of the scans.

    Args:
        bag: What its beginning tells.
        target: Where the copy goes.
        scans: Takes people out of its scans.
        counts: Where is counted what was filtered.
        topic: Of the filtered scans; None: that of the scans, and "_filtered".
        correction: Puts its scans right; None: they are.

    Returns:
        That topic.

    Raises:
        InputError: If one of these topics is in the bag already, or the bag is damaged.
    """
    topic = topic or f"{bag.scans}_filtered"
    added = {topic: SCAN, f"{topic}/people": POSES, f"{topic}/tracks": CLOUD, f"{topic}/legs": POSES}
    for name in added:
        if name in bag.topics:
            raise InputError(f"{named(bag.path)}: has a topic {name} already; give another name by --topic")
    job = _BagFilter(bag, topic, scans, counts)
    stream, right = ScanStream(bag), correction or ScanCorrection()
    with copied_bag(bag.path, target, bag.types, added) as files:
        for file in files:
            for message in file.messages():
                for streamed in stream.take(*message):
                    for scan in right.take(streamed):
                        job.take(file, scan)
            for streamed in stream.rest():
                for scan in right.take(streamed):
                    job.take(file, scan)
            for scan in right.rest():
                job.take(file, scan)
            job.rest(file)
    return topic


class _BagFilter:
    def __init__(
        self, bag: BagBeginning, topic: str, scans: LateScanFilter[StreamedScan], counts: FilterCounts
    ) -> None:
        self._filter, self._counts = scans, counts
        self._types, self._messages = bag.types, PeopleMessages(bag.types, flipped=bag.flipped)
        self._where, self._topic = f"{named(bag.path)}: {bag.scans}", topic

    def _single(self, message: Any, ranges: NDArray[np.float32]) -> Any:
        """Return a `LaserScan` for a message with several echoes a beam."""
        fields = {name: getattr(message, name) for name in ("header", *_GEOMETRY)}
        return self._types.make(SCAN, **fields, ranges=ranges, intensities=np.zeros(0, dtype=np.float32))

    def take(self, file: FileCopy, streamed: StreamedScan) -> None:
        """Filter a scan; write those that are due."""
        with naming(self._where):
            due = self._filter.take(streamed.scan, streamed.odometry, streamed)
        for taken, filtered in due:
            self._write(file, taken, filtered)

    def rest(self, file: FileCopy) -> None:
        """Write the scans that still wait."""
        for taken, filtered in self._filter.rest():
            self._write(file, taken, filtered)

    def _write(self, file: FileCopy, streamed: StreamedScan, filtered: FilteredScan) -> None:
        """Write what came of a scan, at the time of its message."""
        message: Any = streamed.message
        self._counts.add(filtered)
        removed = removed_readings(filtered, streamed.order, len(message.ranges), float(message.angle_increment))
        seen = first_echoes(message.ranges)
        ranges = np.where(removed, np.float32(np.nan), seen).astype(np.float32, copy=False)
        out = {
            self._topic: replace(message, ranges=ranges) if seen is message.ranges else self._single(message, ranges),
            f"{self._topic}/people": self._messages.people(message.header, filtered),
            f"{self._topic}/tracks": self._messages.tracks(message.header, filtered),
            f"{self._topic}/legs": self._messages.legs(message.header, filtered),
        }
        for topic, content in out.items():
            file.write(topic, streamed.time_ns, content)
