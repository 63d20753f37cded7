"""Simulated drives on disk: NAME.log.gz (CARMEN), NAME.gt.tum (true poses), NAME.people.npz (true feet).

The npz holds one array, `feet` (scans, feet, 2), float64, in the world frame of the true poses [m]; NaN where a foot is
not there at that time.
"""

import os
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..bounds import check_points, check_poses
from ..errors import InputError
from ..files.output import read_arrays, replacing
from .carmen import read_carmen
from .carmen_writer import write_carmen
from .drive import RecordedDrive
from .tum import Trajectory, read_tum, write_tum


@dataclass(frozen=True, eq=False)
class SimulatedDrive:
    """A drive with what a simulator knows about it.

    Attributes:
        recording: Scans and odometry; its `reference` are the true poses.
        truth: (n, 3) T_world_robot at each scan [m, m, rad].
        feet: (n, f, 2) where the feet of people truly were at each scan, world frame [m]; f may be 0.

    Raises:
        InputError: If there is not one true pose and one set of feet a scan.
    """

    recording: RecordedDrive
    truth: NDArray[np.float64]
    feet: NDArray[np.float64]

    def __post_init__(self) -> None:
        n = len(self.recording)
        if self.truth.shape != (n, 3):
            raise InputError(f"`truth` must have shape ({n}, 3), one pose a scan, got {self.truth.shape}")
        check_poses(self.truth, "truth")
        if self.feet.ndim != 3 or len(self.feet) != n or self.feet.shape[2] != 2:
            raise InputError(f"`feet` must have shape ({n}, feet, 2), got {self.feet.shape}")
        check_points(self.feet, "feet", gaps=True)


def write_drive(folder: str | os.PathLike[str], drive: SimulatedDrive, name: str | None = None) -> None:
    """Write a drive as the three files of one name (that of the recording if omitted); equal drives, equal bytes."""
    stem = Path(folder) / (name or drive.recording.name)
    write_carmen(_named(stem, "log.gz"), drive.recording)
    write_tum(_named(stem, "gt.tum"), Trajectory(drive.recording.times_s, drive.truth))
    with replacing(_named(stem, "people.npz")) as temporary:
        np.savez_compressed(temporary, feet=drive.feet.astype(np.float64))


def read_drive(folder: str | os.PathLike[str], name: str) -> SimulatedDrive:
    """Read the drive NAME from `folder`; a missing people.npz means that nobody was there.

    Raises:
        InputError: If NAME.log.gz (or NAME.log) or NAME.gt.tum is missing or broken, or the counts do not agree.
    """
    stem = Path(folder) / name
    zipped = _named(stem, "log.gz")
    recording = read_carmen(zipped if zipped.exists() else _named(stem, "log"))
    truth = read_tum(_named(stem, "gt.tum")).poses
    if len(truth) != len(recording):
        raise InputError(f"{_named(stem, 'gt.tum')}: one pose a scan needed, got {len(truth)} for {len(recording)}")
    people = _named(stem, "people.npz")
    feet = read_feet(people) if people.exists() else np.empty((len(recording), 0, 2))
    return SimulatedDrive(replace(recording, reference=truth, name=name), truth, feet)


def read_feet(path: str | os.PathLike[str]) -> NDArray[np.float64]:
    """Return `feet` (scans, feet, 2) of a NAME.people.npz, world frame [m].

    Raises:
        InputError: If the file is missing, is no npz or has no such array of this shape.
    """
    content = read_arrays(path)
    if "feet" not in content:
        raise InputError(f"{os.fspath(path)}: needs an array `feet` (scans, feet, 2), got none of that name")
    if content["feet"].dtype.kind not in "iuf":
        raise InputError(f"{os.fspath(path)}: `feet` must be numbers, got {content['feet'].dtype}")
    feet = np.asarray(content["feet"], dtype=np.float64)
    if feet.ndim != 3 or feet.shape[2] != 2:
        raise InputError(f"{os.fspath(path)}: `feet` must have shape (scans, feet, 2), got {feet.shape}")
    check_points(feet, f"{os.fspath(path)}: feet", gaps=True)
    return feet


def _named(stem: Path, ending: str) -> Path:
    return stem.parent / f"{stem.name}.{ending}"
