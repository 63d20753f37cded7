"""How a bag's laser stands on its robot and what its odometry makes of the way, of a bag that is not held in memory."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import islice

import numpy as np

from ..geometry import between
from ..logs.bag_messages import open_bag
from ..logs.rosbag import TRANSFORMS
from ..logs.scan_stream import BagBeginning, ReadAlready, ScanStream, StreamedScan
from .calibration import MOST_PAIRS, CalibratedOdometry, Calibration, Pair, calibration_of, is_far, said_of


def calibrated_bag(bag: BagBeginning) -> tuple[BagBeginning, CalibratedOdometry]:
    """Return a bag's beginning, and what puts its odometry right, as `calibrated` does with a drive.

    The first scans between which the robot moved tell. Of a robot that moves that takes some minutes of the bag; of one
    that stands, all of it, scan by scan.

    Args:
        bag: What its beginning tells.

    Raises:
        InputError: If it is damaged there.
    """
    mount = np.array(bag.mount)
    found = calibration_of(islice(_pairs(bag), MOST_PAIRS), mount) if bag.has_odometry else Calibration()
    turned_over = found.usable and found.mirrored
    notes = (*bag.notes, *said_of(found, mount))
    return replace(bag, flipped=bag.flipped != turned_over, notes=notes), CalibratedOdometry(found)


def _pairs(bag: BagBeginning) -> Iterator[Pair]:
    first: StreamedScan | None = None
    for streamed in _scans(bag):
        if first is None or first.odometry is None:
            first = streamed
        elif streamed.odometry is not None and is_far(motion := between(first.odometry, streamed.odometry)):
            yield motion, first.scan, streamed.scan
            first = streamed


def _scans(bag: BagBeginning) -> Iterator[StreamedScan]:
    stream = ScanStream(replace(bag, types=ReadAlready()))
    frames = [topic for topic, kind in bag.topics.items() if bag.moving and kind in TRANSFORMS]
    with open_bag(bag.path) as opened:
        for topic, recorded_s, content in opened.with_topics(bag.scans, *filter(None, [bag.odometry]), *frames):
            yield from stream.take(topic, bag.topics[topic], round(1e9 * recorded_s), content)
    yield from stream.rest()
