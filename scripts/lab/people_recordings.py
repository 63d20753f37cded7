"""What the people filter makes of recorded scans, recorded for viewers, where that was asked for."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from ...perception.people_filter import FilteredScan
from ...perception.tracking.people import People
from ...slam.logs.recording import open_recording

Take = Callable[[FilteredScan, People], None]
"""Takes a scan, with who is in it."""


@contextmanager
def recorded_people(path: Path | None, start_s: float) -> Iterator[Take]:
    """Yield what takes scans and people into a file (.mcap, .rrd); None: what takes them nowhere.

    Args:
        path: Of the file, or None.
        start_s: Time of the first scan, from which times are counted [s].
    """
    if path is None:
        yield lambda filtered, people: None
        return
    with open_recording(path) as recording:

        def take(filtered: FilteredScan, people: People) -> None:
            now = filtered.scan.time_s - start_s
            recording.scan(filtered.scan, time_s=now)
            recording.scan(filtered.without_people, "/scan_filtered", time_s=now)
            recording.odometry(now, filtered.odometry)
            recording.people(now, people.positions, people.ids.tolist())

        yield take
