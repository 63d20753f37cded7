"""A bag's scans put right as they come: what the first of them tell of its laser and odometry is done with all.

The bag is never in memory, so `calibrated` and `deskewed` cannot look at all of it. Its first scans between which the
robot moved are looked at instead, some minutes of a drive; where the robot stands, nothing is bent.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..files.input import named, naming
from ..geometry import between, inverse, stands
from ..logs.bag_messages import open_bag
from ..logs.drive import RecordedDrive
from ..logs.rosbag import TRANSFORMS
from ..logs.scan_stream import BagBeginning, ReadAlready, ScanStream, StreamedScan
from .calibration import CalibratedOdometry, Calibration, calibrated, calibration, said_of
from .sweep_time import SweepTime, straightened, sweep_time, usual_step_s, usual_ways

Array = NDArray[np.float64]

_MOST_SCANS, _MOST_RANGES = 3000, 3_000_000  # that are looked at, whichever are fewer: minutes of a drive, 24 MB


class ScanCorrection:
    """Puts the odometry of scans right, and their beams where they were measured, one scan after the other.

    Args:
        found: How the laser stands, and what odometry makes of a metre and a turn.
        sweep: When the beams are measured; None: at once.
        usual_s: Time between scans [s].
    """

    def __init__(self, found: Calibration | None = None, sweep: SweepTime | None = None, usual_s: float = 0.0) -> None:
        self._odometry = CalibratedOdometry(found or Calibration())
        self._sweep, self._usual_s = sweep, usual_s
        self._last: StreamedScan | None = None

    def take(self, streamed: StreamedScan) -> Iterator[StreamedScan]:
        """Take the next scan; yield those that are right now: it, or the one before, which had to wait for it."""
        if streamed.odometry is not None:
            streamed = streamed._replace(odometry=self._odometry.update(streamed.odometry))
        if self._sweep is None:
            yield streamed
            return
        last, self._last = self._last, streamed
        if self._sweep.ended:
            yield self._straight(streamed, streamed, last)
        elif last is not None:
            yield self._straight(last, last, streamed)

    def rest(self) -> Iterator[StreamedScan]:
        """Yield the scan that still waits; it has no next one."""
        if self._sweep is not None and not self._sweep.ended and self._last is not None:
            yield self._last
        self._last = None

    def _straight(self, streamed: StreamedScan, first: StreamedScan, second: StreamedScan | None) -> StreamedScan:
        """Return a scan as if measured at once, by itself and the one after it, or before."""
        assert self._sweep is not None
        if second is None or first.odometry is None or second.odometry is None:
            return streamed
        step_s = abs(second.scan.time_s - first.scan.time_s)
        early, late = (second, first) if self._sweep.ended else (first, second)
        motion = between(early.odometry, late.odometry)  # pyright: ignore[reportArgumentType]
        way = usual_ways(motion[None], np.array([step_s]), self._usual_s)[0]
        scan, order = straightened(streamed.scan, inverse(way) if self._sweep.ended else way, self._sweep)
        return streamed._replace(scan=scan, order=streamed.order[order])


def surveyed_bag(bag: BagBeginning) -> tuple[BagBeginning, ScanCorrection]:
    """Return a bag's beginning with what is wrong with its laser told, and what puts its scans right.

    Args:
        bag: What its beginning tells.

    Raises:
        InputError: If it is damaged there.
    """
    if not bag.has_odometry:
        return bag, ScanCorrection()
    drive = _first_moves(bag)
    found = calibration(drive)
    right = calibrated(drive)
    sweep = sweep_time(right)
    notes = (*bag.notes, *said_of(found, np.array(bag.mount)), *([sweep.note] if sweep else []))
    turned_over = found.usable and found.mirrored
    correction = ScanCorrection(found, sweep, usual_step_s(drive.times_s))
    return replace(bag, flipped=bag.flipped != turned_over, notes=notes), correction


def _first_moves(bag: BagBeginning) -> RecordedDrive:
    """Return the first scans of a bag between which the robot moves."""
    scans, poses, ranges = list[StreamedScan](), list[Array](), 0
    before: StreamedScan | None = None
    for streamed in _scans(bag):
        pose = streamed.odometry
        if pose is None:
            continue
        if before is not None and before.odometry is not None and not stands(between(before.odometry, pose)):
            if not scans or scans[-1] is not before:
                scans.append(before)
                poses.append(before.odometry)
            scans.append(streamed)
            poses.append(pose)
            ranges += len(streamed.scan)
        before = streamed
        if len(scans) >= _MOST_SCANS or ranges >= _MOST_RANGES:
            break
    with naming(f"{named(bag.path)}: {bag.scans}"):
        return RecordedDrive(np.array(poses).reshape(-1, 3), [one.scan for one in scans], None, bag.path.stem)


def _scans(bag: BagBeginning) -> Iterator[StreamedScan]:
    stream = ScanStream(replace(bag, types=ReadAlready()))
    frames = [topic for topic, kind in bag.topics.items() if bag.moving and kind in TRANSFORMS]
    with open_bag(bag.path) as opened:
        for topic, recorded_s, content in opened.with_topics(bag.scans, *filter(None, [bag.odometry]), *frames):
            yield from stream.take(topic, bag.topics[topic], round(1e9 * recorded_s), content)
    yield from stream.rest()
