"""One world in full, for the pictures: poses, landmarks, objects and their ellipses at every scan used."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....slam.ekf.filter import LandmarkFilter
from ....slam.geometry import between, inverse, transform_points
from ....slam.landmarks.clustering import Labels
from ....slam.landmarks.objects import covariance_ellipse, describe_objects
from .drives import LandmarkDrive, blinded, simulate
from .filters import NOISE, Run, run_ekf_slam
from .methods import PAPER, cluster, cluster_by_number

Array = NDArray[np.float64]
Example = Mapping[str, NDArray[Any]]
"""The stored arrays by name."""

COLUMNS = ("odometry", "slam", "lost")
"""Of Figure 6: without EKF, with it, with it and without landmarks for a while."""


def example_cell(seed: int, lost_at: float, lost_way: float, files: Path) -> Mapping[str, Any]:
    """Store one world as `example.npz` in `files`; return its sizes.

    Args:
        seed: Of the world.
        lost_at: Laps after which the laser is covered.
        lost_way: For how long [m].
        files: Folder.
    """
    drive = simulate(seed)
    scans, start = [drive.scans[i] for i in drive.keys], lost_at * drive.lap
    covered = (drive.arcs[drive.keys] >= start) & (drive.arcs[drive.keys] < start + lost_way)
    hidden = blinded(drive, start, lost_way)
    labels = {name: cluster(name, scans).labels for name in ("heuristic", "dbscan")}
    labels |= {name: cluster_by_number(name, scans)[name].labels for name in ("kmeans", "gmm")}
    stored: dict[str, NDArray[Any]] = {
        "path": drive.path,
        "keys": drive.keys,
        "arcs": drive.arcs,
        "posts": transform_points(inverse(drive.truth[0]), drive.posts),
        "covered": covered,
        "odometry": drive.odometry["typical"][drive.keys],
    }
    for name in PAPER:
        empty = [label[:0] if off else label for label, off in zip(labels[name], covered, strict=True)]
        for column, run in (
            ("slam", run_ekf_slam(drive, "typical", drive.scans, labels[name])),
            ("lost", run_ekf_slam(drive, "typical", hidden, empty)),
        ):
            stored |= {f"{name}_{column}_{key}": value for key, value in _of(run).items()}
    for name in PAPER:
        stored |= _objects(drive, labels[name], stored["odometry"], name)
    np.savez_compressed(files / "example.npz", allow_pickle=False, **stored)
    return {"keys": len(drive.keys), "posts": len(drive.posts)}


def _of(run: Run) -> dict[str, Array]:
    """Return the run's poses (k, 3), final landmarks (l, 2) and their covariances (l, 2, 2)."""
    assert run.engine is not None
    assert run.engine.filter is not None
    ekf = run.engine.filter
    numbers = 6 + 2 * np.arange(len(ekf.landmarks))
    P = np.array([ekf.P[n : n + 2, n : n + 2] for n in numbers]).reshape(-1, 2, 2)
    return {"poses": run.poses, "landmarks": ekf.landmarks, "covariances": P}


def _objects(drive: LandmarkDrive, labels: Sequence[Labels], poses: Array, name: str) -> dict[str, NDArray[Any]]:
    """Return the objects of all scans used, robot frame: means, covariances with the odometry's, their scan; points."""
    odometry = odometry_covariances(drive)
    means, covariances, scan, points, of = [], [], [], [], []
    for k, i in enumerate(drive.keys):
        inside = drive.scans[i].points_robot
        found = describe_objects(inside, labels[k])
        means.append(found.means)
        covariances.append(_turned(found.covariances, poses[k, 2]) + odometry[k])
        scan.append(np.full(len(found), k))
        points.append(inside)
        of.append(np.full(len(inside), k))
    return {
        f"{name}_means": np.concatenate(means),
        f"{name}_totals": np.concatenate(covariances),
        f"{name}_scan": np.concatenate(scan),
        "points": np.concatenate(points),
        "points_scan": np.concatenate(of),
    }


def odometry_covariances(drive: LandmarkDrive) -> Array:
    """Return (k, 2, 2) the covariance of the position by odometry alone at the drive's keys [m^2]."""
    odometry = drive.odometry["typical"]
    ekf, found = LandmarkFilter(np.zeros(3), NOISE["typical"]), [np.zeros((2, 2))]
    for before, after in zip(drive.keys[:-1], drive.keys[1:], strict=True):
        ekf.move(between(odometry[before], odometry[after]))
        found.append(ekf.P[:2, :2].copy())
    return np.array(found)


def mean_areas(drive: LandmarkDrive, labels: Sequence[Labels]) -> Array:
    """Return (k,) the mean area of the objects' ellipses without any update (eq. 17) [m^2]; -1 without objects."""
    odometry, poses = odometry_covariances(drive), drive.odometry["typical"][drive.keys]
    areas = []
    for k, i in enumerate(drive.keys):
        found = describe_objects(drive.scans[i].points_robot, labels[k])
        totals = _turned(found.covariances, poses[k, 2]) + odometry[k]
        areas.append([covariance_ellipse(m, P).area for m, P in zip(found.means, totals, strict=True)])
    return np.array([np.mean(each) if each else -1.0 for each in areas])


def _turned(covariances: Array, theta: float) -> Array:
    cos, sin = np.cos(theta), np.sin(theta)
    turn = np.array([[cos, -sin], [sin, cos]])
    return turn @ covariances @ turn.T
