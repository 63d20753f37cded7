"""Where the robot was in the Intel log: two references, since neither is surveyed truth.

The corrected poses are GMapping's, and miss the hand-checked relations by 2.3 degrees on average. So loop closures are
judged by a second reference, too: a chain of scan matches that the hand-checked relations pull into place.
"""

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
from ..slam_run import usable_times

Array = NDArray[np.float64]

READINGS, RELATIONS = "intel_readings_odometry.txt.gz", "intel_relations_by_reading.txt.gz"
_CORRECTED_CLOCK = 976052857.340  # [s] of the readings at time 0 of the corrected log
_CHAIN = np.array([0.01, 0.01, 0.002])  # [m, m, rad] standard deviations of a scan match to the scan before
_CHECKED = np.array([0.02, 0.02, 0.0175])  # [m, m, rad] of a hand-checked relation, as they scatter among each other
_KERNEL = 4.0  # standard deviations


def corrected_poses(logs: Path, drive: RecordedDrive) -> Array:
    """Return (n, 3) the published corrected poses, carried to the scans of `drive` by odometry."""
    readings, corrected = read_readings(logs / READINGS), read_carmen(logs / "intel.gfs.log.gz")
    known = readings_of_scans(corrected.times_s + _CORRECTED_CLOCK, readings.times_s)
    wanted = readings_of_scans(usable_times(drive), readings.times_s)
    nearest = np.abs(known[None] - wanted[:, None]).argmin(axis=1)
    motion = between(readings.odometry[known[nearest]], readings.odometry[wanted])
    return compose(corrected.odometry[nearest], motion)


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
