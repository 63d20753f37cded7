"""A mapped drive as a recording for viewers."""

import json
from collections import defaultdict
from pathlib import Path

import numpy as np

from ...slam.geometry import compose, inverse
from ...slam.logs.drive import RecordedDrive
from ...slam.logs.recording import open_recording
from ...slam.logs.viewer_recording import MAP, ODOM
from ...slam.occupancy_map import OccupancyMap
from ...slam.runner import SlamRun
from .slam_run import usable_times


def record_run(path: Path, drive: RecordedDrive, run: SlamRun, grid: OccupancyMap, people: Path | None) -> None:
    """Write scans, odometry, poses, way and map of a run, by the best knowledge at its end.

    Times begin at 0 s: those of logs may be of any clock, or of none.

    Args:
        path: Of the file, ending in .mcap or .rrd.
        drive: The drive.
        run: What an engine made of it.
        grid: Its map.
        people: people.json of the people who were taken out; None: nobody was.
    """
    tracked = _tracked(people)
    times = usable_times(drive) - usable_times(drive)[0]
    with open_recording(path) as recording:
        for number, (scan, odometry, pose) in enumerate(zip(drive.scans, drive.odometry, run.trajectory, strict=True)):
            now = max(float(times[number]), 0.0)
            recording.scan(scan, time_s=now)
            recording.odometry(now, odometry)
            recording.transform(now, compose(pose, inverse(odometry)), MAP, ODOM)
            if people is not None:
                recording.people(now, [place for _, place in tracked[number]], [key for key, _ in tracked[number]])
        end = max(float(times[-1]), 0.0)
        recording.way(end, np.asarray(run.trajectory))
        recording.map(end, grid)


def _tracked(people: Path | None) -> dict[int, list[tuple[int, list[float]]]]:
    """Return for each scan the number and the place of everybody who was tracked."""
    found: dict[int, list[tuple[int, list[float]]]] = defaultdict(list)
    for person in json.loads(people.read_text(encoding="utf-8"))["people"] if people is not None else ():
        for scan, place in zip(person["scans"], person["positions_m"], strict=True):
            found[scan].append((person["id"], place))
    return found
