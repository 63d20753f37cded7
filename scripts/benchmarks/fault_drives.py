"""The drives that faults are put into: recorded logs with relations or corrected poses, and drawn worlds."""

from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...envs.simulation2d.building_plans import KINDS
from ...envs.simulation2d.drawn_drives import draw_drive
from ...slam.errors import InputError
from ...slam.geometry import between, compose, inverse
from ...slam.logs.carmen import read_carmen
from ...slam.logs.drive import RecordedDrive
from ...slam.logs.relations import read_readings, read_relations
from ...slam.pose_graph.adjustment import adjust
from ...slam.pose_graph.initialisation import initialise
from ...slam.pose_graph.pose_graph import PoseGraph
from ...slam.quality.relations import readings_of_scans, relation_error
from ...slam.quality.trajectory import absolute_error
from ..runs.slam_run import usable_times
from .intel_reference import CORRECTED, READINGS, RELATIONS, corrected_readings

Array = NDArray[np.float64]
Index = NDArray[np.int64]

MOST_CARRIED = 10
"""A relation to a scan that is missing is scored if one of so many scans before or after it is there."""
_CHAIN = np.array([0.03, 0.03, 0.01])  # [m, m, rad] standard deviations of GMapping from scan to scan
_CHECKED = np.array([0.02, 0.02, 0.0175])  # [m, m, rad] of a hand-checked relation, as they scatter among each other
_KERNEL = 4.0  # standard deviations


@dataclass(frozen=True, kw_only=True)
class FaultLog:
    """A recorded log.

    Attributes:
        file: Its name in the folder slam_logs.
        relations: Name of the file of relations between its scans; None: its corrected poses are the reference.
        by_reading: The relations name readings of the Intel log, of which it holds only some.
    """

    file: str
    relations: str | None = None
    by_reading: bool = False


LOGS = {
    "aces": FaultLog(file="aces_with_odometry.log.gz"),
    "belgioioso": FaultLog(file="belgioioso_with_odometry.log.gz"),
    "fhw": FaultLog(file="fhw_with_odometry.log.gz"),
    "intel": FaultLog(file="intel_every5th.log.gz", relations=RELATIONS, by_reading=True),
    "csail": FaultLog(file="mit-csail.clf.gz", relations="mit-csail_relations_by_scan.txt.gz"),
    "intel-910": FaultLog(file=CORRECTED),
    "aces-full": FaultLog(file="aces_full.clf.gz", relations="aces_full_relations_by_scan.txt.gz"),
    "intel-full": FaultLog(file="intel_full.clf.gz", relations="intel_full_relations_by_scan.txt.gz"),
    "seattle": FaultLog(file="seattle-corrected.log.gz"),
    "acapulco": FaultLog(file="acapulco-corrected.log.gz"),
    "orebro": FaultLog(file="orebro-corrected.log.gz"),
}
"""Name -> log. The last three have no odometry but the corrected one; "intel-910" gets that of its readings."""


@dataclass(frozen=True, eq=False)
class ScanRelations:
    """Where the robot stood at one scan, seen from where it stood at another.

    Attributes:
        pairs: (m, 2) numbers of the scans.
        T_first_second: (m, 3).
    """

    pairs: Index
    T_first_second: Array


@dataclass(frozen=True, eq=False)
class FaultDrive:
    """A drive, and what is known about where the robot was.

    Attributes:
        recording: The drive without faults.
        relations: By which errors are told; None: by its reference.
    """

    recording: RecordedDrive
    relations: ScanRelations | None

    def error(self, poses: Array, origin: Index) -> dict[str, float]:
        """Return the error of `poses` (k, 3), estimated for the scans `origin` (k,) of this drive.

        By relations it is their mean [m, deg]; a pose of a scan that is not there is carried on from the nearest one by
        the odometry of this drive. Else it is the ATE: rmse [m] and mean turn [deg].
        """
        if self.relations is None:
            assert self.recording.reference is not None
            absolute = absolute_error(poses, self.recording.reference[origin])
            return {"m": absolute.translation.rmse, "deg": absolute.rotation.mean}
        order = np.argsort(origin, kind="stable")
        known, pairs = origin[order], self.relations.pairs
        right = np.clip(np.searchsorted(known, pairs), 0, len(known) - 1)
        left = np.maximum(right - 1, 0)
        nearest = np.where(np.abs(known[left] - pairs) <= np.abs(known[right] - pairs), left, right)
        near = (np.abs(known[nearest] - pairs) <= MOST_CARRIED).all(axis=1)
        odometry = self.recording.odometry
        motion = between(odometry[known[nearest]], odometry[pairs])
        carried = compose(poses[order][nearest], motion)[near]
        error = relation_error(self.relations.T_first_second[near], carried[:, 0], carried[:, 1])
        return {"m": error.translation.mean, "deg": error.rotation.mean}


@lru_cache(maxsize=2)
def fault_drive(folder: str | None, name: str) -> FaultDrive:
    """Return the drive `name`: a log of `LOGS` in `folder`, or KIND-SEED, a drawn world."""
    if name not in LOGS:
        kind, _, seed = name.rpartition("-")
        return FaultDrive(draw_drive(kind, int(seed)).recording, None)
    log, logs = LOGS[name], Path(folder or "")
    drive = read_carmen(logs / log.file)
    if log.file == CORRECTED:
        odometry = read_readings(logs / READINGS).odometry[corrected_readings(logs / CORRECTED)]
        drive = replace(drive, odometry=odometry, reference=drive.odometry)
    if log.relations is None:
        return FaultDrive(replace(drive, reference=_corrected(drive)), None)
    relations = _by_reading(logs, drive) if log.by_reading else _by_scan(logs / log.relations, len(drive))
    return FaultDrive(drive, relations)


def world_names(count: int) -> list[str]:
    """Return the names of `count` drawn worlds, the kinds by turns."""
    kinds = list(KINDS)
    return [f"{kinds[k % len(kinds)]}-{k // len(kinds)}" for k in range(count)]


def related_truth(drive: FaultDrive, path: Array) -> Array:
    """Return (n, 3) where the robot was: a path (n, 3) of some engine, pulled into place by the relations."""
    assert drive.relations is not None
    count = len(path)
    chain = np.stack((np.arange(count - 1), np.arange(1, count)), axis=-1)
    sigmas = np.concatenate((np.tile(_CHAIN, (count - 1, 1)), np.tile(_CHECKED, (len(drive.relations.pairs), 1))))
    graph = PoseGraph(
        path,
        np.concatenate((chain, drive.relations.pairs)).astype(np.int64),
        np.concatenate((between(path[:-1], path[1:]), drive.relations.T_first_second)),
        np.eye(3) / sigmas[:, None] ** 2,
        np.full(len(sigmas), _KERNEL),
    )
    return adjust(initialise(graph)).poses


def _corrected(drive: RecordedDrive) -> Array:
    """Return the corrected poses; where they stand in the place of an odometry, those."""
    return drive.odometry if drive.reference is None else drive.reference


def _by_scan(path: Path, scans: int) -> ScanRelations:
    relations = read_relations(path)
    pairs = np.stack((relations.first, relations.second), axis=-1).astype(np.int64)
    if not relations.by_reading or pairs.min() < 0 or pairs.max() >= scans:
        raise InputError(f"{path}: relations must name scans by their numbers 0 .. {scans - 1}")
    return _between_two(pairs, relations.T_first_second)


def _by_reading(logs: Path, drive: RecordedDrive) -> ScanRelations:
    """Return the Intel relations between the scans nearest to their readings, by the odometry in between."""
    readings, relations = read_readings(logs / READINGS), read_relations(logs / RELATIONS)
    scans = readings_of_scans(usable_times(drive), readings.times_s)
    moments = np.stack((relations.first, relations.second), axis=-1).astype(np.int64)
    pairs = np.abs(scans[None, None] - moments[..., None]).argmin(axis=-1)
    odometry, at = readings.odometry, scans[pairs]
    first, second = (between(odometry[at[:, k]], odometry[moments[:, k]]) for k in range(2))
    return _between_two(pairs, compose(compose(first, relations.T_first_second), inverse(second)))


def _between_two(pairs: Index, T_first_second: Array) -> ScanRelations:
    apart = pairs[:, 0] != pairs[:, 1]
    return ScanRelations(pairs[apart], T_first_second[apart])
