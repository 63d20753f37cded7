"""Recorded scans with labelled legs, and of people-free buildings, in the .npz layout of the leg_tracker recordings."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...slam.errors import InputError
from ...slam.files.npz import read_arrays
from ...slam.scan import LaserScan

POSITIVE = ("positive_1_labelled.npz", "positive_2_labelled.npz", "positive_3_labelled.npz")
NEGATIVE = "negative_2_left_scans.npz"
SOURCE = (
    "github.com/angusleigh/leg_tracker and leg_tracker_benchmarks; Leigh, Pineau, Olmedo, Zhang, "
    '"Person tracking and following with 2D laser scanners", ICRA 2015'
)


@dataclass(frozen=True, eq=False)
class LegRecording:
    """Scans in order of time, and the legs that somebody labelled in them.

    Attributes:
        name: Where they come from.
        scans: The sweeps.
        legs: For each scan (n, 2) labelled leg centres in the laser frame [m]; what is not labelled may be a leg too.
    """

    name: str
    scans: list[LaserScan]
    legs: list[NDArray[np.float64]]


def read_leg_recording(path: Path) -> LegRecording:
    """Read one .npz recording (keys `ranges`, `angle_min`, ..., and `leg_xy`, `leg_scan_index` where labelled).

    Raises:
        InputError: If the file is missing or has another layout.
    """
    try:
        content = read_arrays(path)
        ranges = content["ranges"].astype(np.float64)
        bearings = content["angle_min"] + content["angle_increment"] * np.arange(ranges.shape[1])
        limits = float(content["range_min"]), float(content["range_max"])
        times = content["stamp"]
        labelled = "leg_xy" in content
        legs = content["leg_xy"] if labelled else np.empty((0, 2))
        rows = content["leg_scan_index"] if labelled else np.empty(0, np.int64)
    except (TypeError, ValueError, KeyError, IndexError) as error:
        raise InputError(f"{path} is not a recording of leg scans: {error}") from None
    scans = [LaserScan(r, bearings, *limits, time_s=float(t)) for r, t in zip(ranges, times, strict=True)]
    return LegRecording(path.stem, scans, [legs[rows == i] for i in range(len(scans))])


def read_leg_recordings(folder: Path) -> tuple[list[LegRecording], LegRecording]:
    """Return the labelled recordings with people and the people-free one from `folder`."""
    return [read_leg_recording(folder / name) for name in POSITIVE], read_leg_recording(folder / NEGATIVE)
