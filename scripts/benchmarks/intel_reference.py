"""Where the robot was in the Intel log: two references, since neither is surveyed truth.

The corrected poses are GMapping's, of 910 other scans of the drive. The other reference is a chain of scan matches that
hand-checked relations pull into place.
"""

import gzip
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...slam.geometry import between, compose, inverse
from ...slam.logs.carmen import read_carmen
from ...slam.logs.drive import RecordedDrive
from ...slam.logs.relations import read_readings, read_relations
from ...slam.pose_graph.adjustment import adjust
from ...slam.pose_graph.initialisation import initialise
from ...slam.pose_graph.pose_graph import PoseGraph
from ...slam.quality.relations import readings_of_scans
from ...slam.scan_to_scan.matchers import make_matcher
from ..runs.slam_run import usable_times

Array = NDArray[np.float64]

READINGS, RELATIONS = "intel_readings_odometry.txt.gz", "intel_relations_by_reading.txt.gz"
CORRECTED = "intel.gfs.log.gz"
_CHAIN = np.array([0.01, 0.01, 0.002])  # [m, m, rad] standard deviations of a scan match to the scan before
_CHECKED = np.array([0.02, 0.02, 0.0175])  # [m, m, rad] of a hand-checked relation, as they scatter among each other
_CORRECTED = np.array([0.03, 0.03, 0.0087])  # [m, m, rad] of a corrected pose among its neighbours
_MOST_GAP = 30  # readings from a corrected scan to the scan that it holds in place
_PLAUSIBLE = (0.3, 0.35)  # [m, rad] by which a match may differ from the odometry in between
_KERNEL = 4.0  # standard deviations


def published_poses(logs: Path, drive: RecordedDrive) -> Array:
    """Return (n, 3) the published corrected poses, each scan of `drive` by the nearest corrected one in the log.

    It is carried there by a scan match, since from one corrected scan to the next the odometry is off by 2.8 degrees
    (median); by odometry only where the scans do not match.
    """
    return _carried(logs, drive)[0]


def corrected_poses(logs: Path, drive: RecordedDrive, local: Array) -> Array:
    """Return (n, 3) the published corrected poses, smoothed by a trajectory `local` (n, 3) that closed no loop.

    One pose by itself is not good to 1 degree: of pairs of corrected scans from about the same place, 4.6 % (of 476)
    lie farther apart than that from where both PL-ICP and the global matcher put them.
    """
    poses, matched, gaps, nearest = _carried(logs, drive)
    at = np.flatnonzero(matched & (gaps <= _MOST_GAP))
    order = at[np.argsort(gaps[at], kind="stable")]
    anchors = np.sort(order[np.unique(nearest[order], return_index=True)[1]])  # a scan for each corrected one
    links = np.stack((np.arange(1, len(local)), np.arange(2, len(local) + 1)), axis=-1)
    ties = np.stack((np.zeros_like(anchors), anchors + 1), axis=-1)  # pose 0 is the map's frame
    sigmas = np.concatenate((np.tile(_CHAIN, (len(links), 1)), np.tile(_CORRECTED, (len(ties), 1))))
    graph = PoseGraph(
        np.concatenate((np.zeros((1, 3)), poses)),
        np.concatenate((links, ties)).astype(np.int64),
        np.concatenate((between(local[:-1], local[1:]), poses[anchors])),
        np.eye(3) / sigmas[:, None] ** 2,
        np.full(len(sigmas), _KERNEL),
    )
    adjusted = adjust(graph).poses
    return between(adjusted[0], adjusted[1:])


def _carried(logs: Path, drive: RecordedDrive) -> tuple[Array, NDArray[np.bool_], Array, NDArray[np.int64]]:
    """Return (n, 3) poses, (n,) whether by a match, readings from the corrected scan, and which scan that is."""
    odometry = read_readings(logs / READINGS).odometry
    corrected, known = read_carmen(logs / CORRECTED), corrected_readings(logs / CORRECTED)
    wanted = readings_of_scans(usable_times(drive), read_readings(logs / READINGS).times_s)
    nearest = np.abs(known[None] - wanted[:, None]).argmin(axis=1)
    motions, matcher = between(odometry[known[nearest]], odometry[wanted]), make_matcher("plicp")
    matched = wanted == known[nearest]
    for k in np.flatnonzero(~matched):
        motion = motions[k]
        match = matcher.match(corrected.scans[nearest[k]], drive.scans[k], motion)
        off = between(motion, match.pose)
        matched[k] = match.converged and np.hypot(off[0], off[1]) < _PLAUSIBLE[0] and abs(off[2]) < _PLAUSIBLE[1]
        if matched[k]:
            motions[k] = match.pose
    return compose(corrected.odometry[nearest], motions), matched, np.abs(wanted - known[nearest]), nearest


def corrected_readings(path: Path) -> NDArray[np.int64]:
    """Return the reading that each scan of the corrected log is, by the order of its lines (its times are too coarse).

    Every ODOM line is a reading, a FLASER line corrects the last one, and the ODOM line after it repeats its pose.
    """
    reading, last, found = -1, "", list[int]()
    with gzip.open(path, "rt") as lines:
        for line in lines:
            word = line.split(maxsplit=1)[0]
            reading += word == "ODOM" and last != "FLASER"
            if word == "FLASER":
                found.append(reading)
            last = word if word in ("ODOM", "FLASER") else last
    return np.array(found, dtype=np.int64)


def related_poses(logs: Path, drive: RecordedDrive, local: Array) -> Array:
    """Return (n, 3) poses by the hand-checked relations and a trajectory `local` (n, 3) that closed no loop."""
    readings, relations = read_readings(logs / READINGS), read_relations(logs / RELATIONS)
    scans = readings_of_scans(usable_times(drive), readings.times_s)
    moments = np.stack((relations.first, relations.second), axis=-1).astype(np.int64)
    pairs = np.abs(scans[None, None] - moments[..., None]).argmin(axis=-1)
    odometry, at = readings.odometry, scans[pairs]
    first, second = (between(odometry[at[:, k]], odometry[moments[:, k]]) for k in range(2))
    checked = compose(compose(first, relations.T_first_second), inverse(second))
    apart = pairs[:, 0] != pairs[:, 1]
    chain = np.stack((np.arange(len(local) - 1), np.arange(1, len(local))), axis=-1)
    sigmas = np.concatenate((np.tile(_CHAIN, (len(chain), 1)), np.tile(_CHECKED, (int(apart.sum()), 1))))
    graph = PoseGraph(
        local,
        np.concatenate((chain, pairs[apart])).astype(np.int64),
        np.concatenate((between(local[:-1], local[1:]), checked[apart])),
        np.eye(3) / sigmas[:, None] ** 2,
        np.full(len(sigmas), _KERNEL),
    )
    return adjust(initialise(graph)).poses
