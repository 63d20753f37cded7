"""A drive through the filters: none, localization on the map of objects (the paper's), EKF-SLAM."""

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ....slam.ekf.calibrated_motion import OdometryNoise
from ....slam.ekf.config import EkfSlamConfig
from ....slam.ekf.engine import EkfSlam
from ....slam.ekf.localization import LocalizationConfig, ObjectLocalizer
from ....slam.geometry import between, inverse, transform_points
from ....slam.landmarks.clustering import Labels
from ....slam.landmarks.objects import SightingConfig, see_landmarks
from ....slam.logs.drive import RecordedDrive
from ....slam.quality.trajectory import absolute_error
from ....slam.runner import run_slam
from ....slam.scan import LaserScan
from .drives import LandmarkDrive
from .methods import Replay

Array = NDArray[np.float64]

SURE = OdometryNoise(
    sigma_scale=5e-4, sigma_turn=5e-4, sigma_drift=1e-4, alpha1=1e-3, alpha2=5e-4, alpha3=1e-3, alpha4=5e-4
)
"""What is known of wheels without error: Q small, as the paper says."""
NOISE = {"perfect": SURE, "typical": OdometryNoise()}
LOCALIZATION = {
    "perfect": LocalizationConfig(sigma_way=0.005, sigma_turn=0.003),
    "typical": LocalizationConfig(sigma_way=0.05, sigma_turn=0.03),
}
_WINDOW_M = 2.0


@dataclass(frozen=True, eq=False)
class Run:
    """What a filter made of a drive.

    Attributes:
        poses: (k, 3) T_map_robot at the drive's keys.
        seconds: (k,) CPU time of associating and updating [s].
        engine: The engine, of SLAM; else None.
    """

    poses: Array
    seconds: Array
    engine: EkfSlam | None = None


def run_ekf_slam(drive: LandmarkDrive, robot: str, scans: Sequence[LaserScan], labels: Sequence[Labels]) -> Run:
    """Return EKF-SLAM on `scans` (n,), whose keys are clustered as `labels` (k,) say."""
    config = EkfSlamConfig(travel=0.0, turn=0.0, odometry=NOISE[robot])
    engine = EkfSlam(config, Replay(labels))
    used = RecordedDrive(drive.odometry[robot][drive.keys], [scans[i] for i in drive.keys], None, robot)
    run = run_slam(engine, used, clock=time.process_time)
    return Run(run.online, run.seconds, engine)


def run_localization(drive: LandmarkDrive, robot: str, scans: Sequence[LaserScan], labels: Sequence[Labels]) -> Run:
    """Return the paper's localization on the map of objects; the unicycle is driven every 0.1 s."""
    objects = transform_points(inverse(drive.truth[0]), drive.posts)
    localizer, clusterer, config = ObjectLocalizer(objects, np.zeros(3), LOCALIZATION[robot]), Replay(labels), SIGHTING
    moves, keys = between(drive.odometry[robot][:-1], drive.odometry[robot][1:]), set(drive.keys.tolist())
    poses, seconds = [], []
    for i, scan in enumerate(scans):
        start = time.process_time()
        if i:
            u, v, turn = moves[i - 1].tolist()
            localizer.predict(float(np.copysign(np.hypot(u, v), u)) / 0.1, turn / 0.1, 0.1)
        if i in keys:
            seen = see_landmarks(scan, clusterer, config)
            localizer.update(seen.z, seen.R)
            seconds.append(time.process_time() - start)
            poses.append(localizer.filter.x.copy())
    return Run(np.array(poses), np.array(seconds))


SIGHTING = SightingConfig()


def errors_of(drive: LandmarkDrive, poses: Array) -> dict[str, float]:
    """Return the errors of `poses` (k, 3) at the drive's keys.

    `rms_m`: of the position in the frame of the first pose, nothing aligned; `ate_m`: after the best rigid motion;
    `y_sum_m`, `y_mean_m`: the paper's: what `y_errors` gives, summed and averaged; `end_m`: at the end.
    """
    truth = drive.path[drive.keys]
    off = np.hypot(*(poses - truth)[:, :2].T)
    y = y_errors(poses, drive.path, drive.keys)
    return {
        "rms_m": float(np.sqrt((off**2).mean())),
        "ate_m": absolute_error(poses, truth).translation.rmse,
        "y_sum_m": float(np.nansum(y)),
        "y_mean_m": float(np.nanmean(y)),
        "end_m": float(off[-1]),
    }


def y_errors(poses: Array, path: Array, keys: NDArray[np.int64]) -> Array:
    """Return (k,) how far each pose is off `path` in y where both have the same x (Urvina et al. 2023, Figure 4).

    Args:
        poses: (k, 2 or 3) estimates [m].
        path: (n, 2 or 3) reference [m].
        keys: (k,) where on the path each estimate belongs; looked for within 2 m of way; NaN: nothing has its x.
    """
    steps = np.hypot(*np.diff(path[:, :2], axis=0).T)
    arcs = np.concatenate(([0.0], np.cumsum(steps)))
    found = np.full(len(poses), np.nan)
    for k, (x, y) in enumerate(poses[:, :2]):
        near = np.flatnonzero(np.abs(arcs - arcs[keys[k]]) <= _WINDOW_M)
        a, b = path[near[:-1]], path[near[1:]]
        run = b[:, 0] - a[:, 0]
        share = np.divide(x - a[:, 0], run, out=np.full(len(run), -1.0), where=np.abs(run) > 1e-12)
        inside = (share >= 0.0) & (share <= 1.0)
        if inside.any():
            found[k] = np.abs(a[inside, 1] + share[inside] * (b[inside, 1] - a[inside, 1]) - y).min()
    return found
