"""Who was there before being believed in: people in scans of a recording, told a moment later (fixed-lag smoothing).

Nobody is a person at first sight: it takes half a second of steps until a hypothesis is believed in, and by then its
returns stand in the map. A recording can wait. Whoever is believed in a moment later was there all the time that the
hypothesis has been followed, and is told of from its first scan on.
"""

from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..slam.errors import InputError
from ..slam.logs.drive import RecordedDrive
from ..slam.scan import LaserScan
from .legs.detector import Detector
from .people_filter import FilteredScan, PeopleFilter, PeopleFilterConfig
from .tracking.camera import SeenPeople
from .tracking.numbers import Numbers, numbers_of
from .tracking.tracker import TrackerUpdate, people_of

LAG_S = 1.0
"""A step of each leg, which is what it takes to know somebody. Of 88 annotated people around a robot that drives, 0.46
are found at once, 0.65 after 0.5 s, 0.73 after 1 s and after 2 s; of walkers in twenty simulated offices 0.936, 0.975
after 0.6 s, 0.983 and 0.987, and furniture is taken for somebody as seldom as before (0.019; 0.023, 0.025) [s]."""


class HindsightFilter:
    """A `PeopleFilter` for recordings: each scan comes out `lag_s` later, with whoever is known to have been there.

    Args:
        config: Of the people filter. The tracker of Ye 2021 has no hypotheses to look back on: of it, all stays as it
            is.
        detector: Finds legs, in place of the configured one.
        lag_s: How much later [s]; 0 changes nothing.

    Raises:
        InputError: If there is no such forest, or the lag is negative.
    """

    def __init__(
        self, config: PeopleFilterConfig | None = None, detector: Detector | None = None, lag_s: float = LAG_S
    ) -> None:
        if not 0.0 <= lag_s < np.inf:
            raise InputError(f"`lag_s` must be 0 or more [s], got {lag_s}")
        self._filter, self._lag_s = PeopleFilter(config, detector), lag_s
        self._numbers: Numbers = numbers_of(self._filter.config.tracker)
        self._waiting: deque[tuple[LaserScan, TrackerUpdate]] = deque()
        self._known: dict[int, tuple[int, float]] = {}

    @property
    def config(self) -> PeopleFilterConfig:
        """Of the people filter."""
        return self._filter.config

    def update(
        self, scan: LaserScan, odometry: ArrayLike | None = None, seen: SeenPeople | None = None
    ) -> list[FilteredScan]:
        """Take the next scan, as `PeopleFilter.update`; return those that are due, in their order.

        Raises:
            InputError: As there.
        """
        update = self._filter.track(scan, odometry, seen)
        self._waiting.append((scan, update))
        self._note(update.hypotheses)
        due = []
        while self._waiting and scan.time_s - self._waiting[0][0].time_s >= self._lag_s - 1e-9:
            due.append(self._looked_back(*self._waiting.popleft()))
        return due

    def finish(self) -> list[FilteredScan]:
        """Return the scans that still wait: the drive is over."""
        rest = [self._looked_back(*waiting) for waiting in self._waiting]
        self._waiting.clear()
        return rest

    def over(self, drive: Iterable[tuple[LaserScan, ArrayLike | None]]) -> Iterator[FilteredScan]:
        """Yield each scan of a whole drive, given with its odometry or None, as `update` and `finish` return them."""
        for scan, odometry in drive:
            yield from self.update(scan, odometry)
        yield from self.finish()

    def _note(self, rows: NDArray[Any]) -> None:
        """Remember under which number, and how surely, hypotheses were believed in first; forget those long over."""
        known, oldest = self._known, self._waiting[0][1].hypotheses["serial"].min(initial=np.iinfo(np.int64).max)
        for serial in [serial for serial in known if serial < oldest]:
            del known[serial]
        for row in rows[rows["id"] >= 0]:
            known.setdefault(int(row["serial"]), (int(row["id"]), float(row["odds"])))

    def _looked_back(self, scan: LaserScan, update: TrackerUpdate) -> FilteredScan:
        """Return a scan with the people in it by what is known now."""
        rows, people = update.hypotheses.copy(), update.people
        for row in rows:
            if row["id"] < 0 and int(row["serial"]) in self._known:
                row["id"], row["odds"] = self._known[int(row["serial"])]
        if len(rows):
            people = people_of(rows, people.time_s, self._numbers)
        return FilteredScan(scan, update.odometry, people, update.detections, self.config.removal)


def filtered_scans(
    drive: RecordedDrive, config: PeopleFilterConfig | None = None, lag_s: float = LAG_S
) -> Iterator[FilteredScan]:
    """Yield each scan of `drive` as a fresh `HindsightFilter` leaves it; with a `lag_s` of 0, as a `PeopleFilter` does.

    Stamps of a log may be rounded, go back, or stand still; people are tracked by times that increase all the same.
    Where the log has no odometry and nobody has made any, it is made of the scans.
    """
    people_filter = HindsightFilter(config, lag_s=lag_s)
    times_s = _increasing(drive.times_s, people_filter.config.tracker.motion.reference_rate_hz)
    said = drive.odometry if drive.has_odometry or drive.odometry.any() else [None] * len(drive)
    timed = (
        scan if scan.time_s == time_s else replace(scan, time_s=time_s)
        for scan, time_s in zip(drive.scans, times_s.tolist(), strict=True)
    )
    for scan, filtered in zip(drive.scans, people_filter.over(zip(timed, said, strict=True)), strict=True):
        yield replace(filtered, scan=scan)


def _increasing(times_s: NDArray[np.float64], rate_hz: float) -> NDArray[np.float64]:
    """Return stamps (n,) that increase: a step that does not is the median of those that do, or one at `rate_hz`."""
    steps = np.diff(times_s)
    forward = steps > 0.0
    if forward.all():
        return times_s
    usual = float(np.median(steps[forward])) if 2 * forward.sum() > len(steps) else 1.0 / rate_hz
    return times_s[0] + np.concatenate(([0.0], np.cumsum(np.where(forward, steps, usual))))
