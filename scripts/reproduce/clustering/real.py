"""Real data: labelled legs as round objects for DBSCAN, and recorded drives through the landmark and grid engines."""

import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....slam.engine import make_slam
from ....slam.landmarks.clustering import Dbscan
from ....slam.landmarks.objects import SightingConfig, describe_objects, see_landmarks
from ....slam.logs.carmen import read_carmen
from ....slam.quality.trajectory import absolute_error
from ....slam.scan import LaserScan

LEG_FILES = ("positive_1", "positive_2", "positive_3")
EPSILONS = (0.05, 0.08, 0.1, 0.13, 0.2, 0.3, 0.5)
LEG_RADIUS = 0.055
NEAR_M = 0.1
"""A leg is found where the mean of a cluster is no further from its label [m]."""
WIDEST_M = 0.1
"""A cluster is leg-sized if its points lie within this of their mean, RMS [m]."""
LOGS = {"belgioioso": "belgioioso_with_odometry.log.gz", "aces": "aces_with_odometry.log.gz"}
ENGINES: dict[str, dict[str, Any]] = {
    "ekf": {"sigma_shape": 0.05, "widest": 0.25},
    "cartographer": {},
    "gmapping": {},
}


def legs_cell(data: str) -> Mapping[str, Any]:
    """Return, over epsilon, what DBSCAN (3 points and more) makes of the labelled legs."""
    folder = Path(data) / "legs"
    recordings = [_labelled(folder / f"{name}_labelled.npz") for name in LEG_FILES]
    return {str(epsilon): _legs_found(recordings, epsilon) for epsilon in EPSILONS}


def _labelled(path: Path) -> list[tuple[LaserScan, NDArray[np.float64]]]:
    """Return the labelled scans of a recording, each with its legs (l, 2) in the laser frame."""
    with np.load(path, allow_pickle=False) as stored:
        ranges = stored["ranges"].astype(np.float64)
        bearings = float(stored["angle_min"]) + float(stored["angle_increment"]) * np.arange(ranges.shape[1])
        limits = float(stored["range_min"]), float(stored["range_max"])
        legs, rows = stored["leg_xy"].astype(np.float64), stored["leg_scan_index"]
    return [(LaserScan(ranges[row], bearings, *limits), legs[rows == row]) for row in np.unique(rows)]


def _legs_found(
    recordings: list[list[tuple[LaserScan, NDArray[np.float64]]]], epsilon: float
) -> dict[str, float | int]:
    """Return counts of legs: with a cluster of their own of the right size, sharing one, in a larger one, missed."""
    counts = dict.fromkeys(("legs", "alone", "shared", "in_larger", "missed", "landmarks"), 0)
    off: list[float] = []
    clusterer, config = Dbscan(epsilon=epsilon, min_points=3), SightingConfig(radius=LEG_RADIUS, widest=WIDEST_M)
    for scan, legs in (pair for recording in recordings for pair in recording):
        points, labels = scan.points, clusterer.fit_predict(scan.points)
        objects = describe_objects(points, labels)
        size = np.sqrt(np.trace(objects.covariances, axis1=1, axis2=2))
        nearest = np.hypot(*(legs[:, None] - points).transpose(2, 0, 1)).argmin(axis=1)
        present = np.unique(labels[labels >= 0])
        own = labels[nearest]
        z = see_landmarks(scan, clusterer, config).z
        centres = z[:, :1] * np.stack((np.cos(z[:, 1]), np.sin(z[:, 1])), axis=-1)
        counts["legs"] += len(legs)
        for leg, label in zip(legs, own, strict=True):
            if label < 0:
                counts["missed"] += 1
                continue
            place = int(np.searchsorted(present, label))
            distance = float(np.hypot(*(objects.means[place] - leg)))
            if (own == label).sum() > 1:
                counts["shared"] += 1
            elif size[place] > WIDEST_M or distance > NEAR_M:
                counts["in_larger"] += 1
            else:
                counts["alone"] += 1
                off.append(distance)
                counts["landmarks"] += int(len(z) > 0 and np.hypot(*(centres - leg).T).min() < NEAR_M + LEG_RADIUS)
    return {**counts, "median_off_m": float(np.median(off))}


def log_cell(data: str, log: str, engine: str) -> Mapping[str, Any]:
    """Return the error of an engine on a recorded drive against the log's own corrected poses."""
    drive = read_carmen(Path(data) / "slam_logs" / LOGS[log])
    assert drive.reference is not None
    slam, sightings, matched, used = make_slam(engine, seed=0, **ENGINES[engine]), 0.0, 0.0, 0
    start = time.process_time()
    for odometry, scan in zip(drive.odometry, drive.scans, strict=True):
        update = slam.update(odometry, scan)
        used += int(update.integrated)
        sightings += update.diagnostics.get("sightings", 0.0)
        matched += update.diagnostics.get("matched", 0.0)
    seconds = time.process_time() - start
    slam.finish()
    error = absolute_error(slam.trajectory(), drive.reference)
    result: dict[str, Any] = {
        "ate_m": error.translation.rmse,
        "odometry_ate_m": absolute_error(drive.odometry, drive.reference).translation.rmse,
        "scans": len(drive.scans),
        "used": used,
        "timing": {"seconds": seconds},
    }
    if engine == "ekf":
        result |= {"sightings": sightings / max(used, 1), "matched": matched / max(used, 1)}
    return result
