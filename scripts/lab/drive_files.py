"""A drive with its filtered scans in one file, for experiments that map the same drive many times."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...slam.files.output import replacing
from ...slam.logs.drive import RecordedDrive
from ...slam.logs.drive_folder import SimulatedDrive
from ...slam.scan import LaserScan


@dataclass(frozen=True, eq=False)
class MappingInput:
    """What there is to map.

    Attributes:
        drive: The raw scans, odometry and truth.
        filtered: The scans as the robot's people filter left them.
    """

    drive: SimulatedDrive
    filtered: list[LaserScan]

    def scans(self, kind: str, usable_range: float) -> list[LaserScan]:
        """Return the scans "raw" or "filtered" as a laser of `usable_range` [m] would have given them."""
        chosen = {"raw": self.drive.recording.scans, "filtered": self.filtered}[kind]
        return [limited(scan, usable_range) for scan in chosen]


def limited(scan: LaserScan, usable_range: float) -> LaserScan:
    """Return `scan` with nothing seen beyond `usable_range` [m]."""
    if scan.range_max <= usable_range:
        return scan
    return LaserScan(scan.ranges, scan.bearings, scan.range_min, usable_range, scan.time_s, scan.T_robot_lidar)


def save_input(path: Path, tour: MappingInput) -> None:
    """Write `tour` to `path` (.npz). Ranges are kept to single precision."""
    scans = tour.drive.recording.scans
    first = scans[0]
    with replacing(path) as temporary:
        np.savez_compressed(
            temporary,
            odometry=tour.drive.recording.odometry,
            truth=tour.drive.truth,
            feet=tour.drive.feet,
            ranges=np.array([scan.ranges for scan in scans], dtype=np.float32),
            dropped=np.array([np.isnan(scan.ranges) for scan in tour.filtered]),
            times=np.array([scan.time_s for scan in scans]),
            bearings=first.bearings,
            limits=np.array([first.range_min, first.range_max]),
            mount=np.array(first.T_robot_lidar),
            name=np.array(tour.drive.recording.name),
        )


def load_input(path: Path) -> MappingInput:
    """Return what `save_input` wrote."""
    with np.load(path, allow_pickle=False) as stored:
        data = {name: stored[name] for name in stored.files}
    low, high = (float(limit) for limit in data["limits"])
    x, y, theta = (float(value) for value in data["mount"])
    raw = [
        LaserScan(ranges.astype(np.float64), data["bearings"], low, high, float(time_s), (x, y, theta))
        for ranges, time_s in zip(data["ranges"], data["times"], strict=True)
    ]
    filtered = [scan.without(dropped) for scan, dropped in zip(raw, data["dropped"], strict=True)]
    recording = RecordedDrive(data["odometry"], raw, data["truth"], str(data["name"]))
    return MappingInput(SimulatedDrive(recording, data["truth"], data["feet"]), filtered)


def load_truth(path: Path) -> NDArray[np.float64]:
    """Return the true poses T_world_robot (n, 3) of what `save_input` wrote, without its scans."""
    with np.load(path, allow_pickle=False) as stored:
        return stored["truth"]
