"""What is computed of each world: the paper's experiment, consistency, recovery, and the parameters swept."""

import copy
import time
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....slam.ekf.engine import EkfSlam
from ....slam.geometry import between, compose, wrap_angle
from ....slam.landmarks.objects import see_landmarks
from ....slam.quality.trajectory import absolute_error
from .drives import ROBOTS, LandmarkDrive, blinded, shortened, simulate
from .example import mean_areas
from .filters import SIGHTING, errors_of, run_ekf_slam, run_localization
from .methods import METHODS, Clustered, Replay, cluster, cluster_by_number

Array = NDArray[np.float64]

LOST_AT, LOST_WAY = 1.2, 6.0
"""The laser is covered from this many laps on, for so long [m]."""
GAPS = {"6 m": (6.0, False), "12 m": (12.0, False), "6 m and a slip": (6.0, True)}
"""Name -> way without landmarks [m], and whether the wheels slip on it by up to 0.5 m and 10 degrees."""
DISTANCES, NEIGHBOURS, REACHES = (0.1, 0.15, 0.25, 0.5, 1.0, 1.5, 2.0), (1, 2, 3, 4, 5), (4.0, 6.0, 8.0)


def clusters_of(drive: LandmarkDrive, reach: float = 8.0) -> dict[str, Clustered]:
    """Return the clusters of the drive's key scans, seen to `reach` [m], by every method."""
    scans = [shortened(drive.scans[i], reach) for i in drive.keys]
    found = {name: cluster(name, scans) for name in ("heuristic", "dbscan")}
    return found | cluster_by_number("kmeans", scans) | cluster_by_number("gmm", scans)


def world_cell(seed: int) -> Mapping[str, Any]:
    """Return the paper's experiment in one world: methods, robots, with and without filter, lost and not."""
    drive = simulate(seed)
    found = clusters_of(drive)
    lost = blinded(drive, LOST_AT * drive.lap, LOST_WAY)
    robots: dict[str, Any] = {}
    timing: dict[str, Any] = {name: {"cluster_s": float(found[name].seconds.sum())} for name in METHODS}
    for robot in ROBOTS:
        robots[robot] = {"odometry": errors_of(drive, drive.odometry[robot][drive.keys])}
        for name in METHODS:
            slam = run_ekf_slam(drive, robot, drive.scans, found[name].labels)
            known = run_localization(drive, robot, drive.scans, found[name].labels)
            hidden = run_ekf_slam(drive, robot, lost, _labels_of_lost(found[name], drive))
            robots[robot][name] = {
                "slam": errors_of(drive, slam.poses),
                "localization": errors_of(drive, known.poses),
                "lost": errors_of(drive, hidden.poses),
            }
            timing[name][f"{robot}_filter_s"] = float(slam.seconds.sum())
    sightings = {name: _sightings(drive, found[name]) for name in METHODS}
    growth = {"arc_m": drive.arcs[drive.keys].tolist(), "area_m2": mean_areas(drive, found["kmeans"].labels).tolist()}
    size = {"path_m": float(drive.arcs[-1]), "posts": len(drive.posts), "keys": len(drive.keys)}
    return {**size, "robots": robots, "sightings": sightings, "growth": growth, "timing": timing}


def _labels_of_lost(found: Clustered, drive: LandmarkDrive) -> list[NDArray[np.int64]]:
    """Return the labels with those of covered scans emptied."""
    start = LOST_AT * drive.lap
    covered = (drive.arcs[drive.keys] >= start) & (drive.arcs[drive.keys] < start + LOST_WAY)
    return [label[:0] if hidden else label for label, hidden in zip(found.labels, covered, strict=True)]


def _sightings(drive: LandmarkDrive, found: Clustered) -> float:
    """Return how many landmarks a scan shows on average."""
    replay = Replay(found.labels)
    return float(np.mean([len(see_landmarks(drive.scans[i], replay, SIGHTING).z) for i in drive.keys]))


def consistency_cell(seed: int) -> Mapping[str, Any]:
    """Return the squared pose error by its covariance (NEES) of the engine as it ships, at every scan."""
    drive = simulate(seed)
    path, odometry, engine, nees = drive.path, drive.odometry["typical"], EkfSlam(), []
    start = time.process_time()
    for moved, scan, truth in zip(odometry, drive.scans, path, strict=True):
        error = engine.update(moved, scan).pose - truth
        error[2] = wrap_angle(error[2])
        assert engine.filter is not None
        nees.append(float(error @ np.linalg.solve(engine.filter.P[:3, :3], error)))
    seconds = time.process_time() - start
    off = np.hypot(*(engine.trajectory() - path)[:, :2].T)
    return {
        "nees": [round(value, 4) for value in nees],
        "path_m": float(drive.arcs[-1]),
        "posts": len(drive.posts),
        "mapped": len(engine.times_seen),
        "rms_m": float(np.sqrt((off**2).mean())),
        "ate_m": absolute_error(engine.trajectory(), path).translation.rmse,
        "odometry_rms_m": float(np.sqrt((np.hypot(*(odometry - path)[:, :2].T) ** 2).mean())),
        "odometry_ate_m": absolute_error(odometry, path).translation.rmse,
        "timing": {"ms_per_scan": 1e3 * seconds / len(path)},
    }


def recovery_cell(seed: int) -> Mapping[str, Any]:
    """Return what becomes of the error when all landmarks are lost for a while on the second lap."""
    drive = simulate(seed)
    start = int(np.searchsorted(drive.arcs, LOST_AT * drive.lap))
    engine = EkfSlam()
    for odometry, scan in zip(drive.odometry["typical"][:start], drive.scans[:start], strict=True):
        engine.update(odometry, scan)
    rng = np.random.default_rng((seed, 1))
    return {name: _recovered(drive, copy.deepcopy(engine), start, *gap, rng) for name, gap in GAPS.items()}


def _recovered(
    drive: LandmarkDrive, engine: EkfSlam, start: int, way: float, slips: bool, rng: np.random.Generator
) -> dict[str, Any]:
    scans, odometry = blinded(drive, drive.arcs[start], way), drive.odometry["typical"]
    end = int(np.searchsorted(drive.arcs, drive.arcs[start] + way))
    if slips:
        odometry = _slipped(odometry, (start + end) // 2, rng)
    first, error = None, []
    for i in range(start, len(scans)):
        update = engine.update(odometry[i], scans[i])
        if first is None and i >= end and update.diagnostics["sightings"] > 0:
            first = i
        error.append(float(np.hypot(*(engine.pose - drive.path[i])[:2])))
    off = np.array(error)
    before = float(np.hypot(*(engine.trajectory()[start - 1] - drive.path[start - 1])[:2]))
    if first is None:
        return {"seen_again": False}
    after = int(np.searchsorted(drive.arcs, drive.arcs[first] + 3.0)) - start
    if after >= len(off):
        return {"seen_again": False}
    return {
        "seen_again": True,
        "before_m": before,
        "peak_m": float(off[: first - start].max(initial=0.0)),
        "within_3_m": float(off[after]),
        "worst_later_m": float(off[after:].max()),
        "blind_way_m": float(drive.arcs[first] - drive.arcs[start]),
    }


def _slipped(odometry: Array, at: int, rng: np.random.Generator) -> Array:
    """Return the odometry (n, 3) with a jump at the scan `at` that the robot did not make."""
    direction, way, turn = rng.uniform(-np.pi, np.pi), rng.uniform(0.1, 0.5), rng.uniform(-1.0, 1.0) * np.radians(10.0)
    jumped = compose(odometry[at - 1], np.array([way * np.cos(direction), way * np.sin(direction), turn]))
    return np.concatenate((odometry[:at], compose(jumped, between(odometry[at - 1], odometry[at:]))))


def sweep_cell(seed: int, slow: bool) -> Mapping[str, Any]:
    """Return error and time over the paper's three parameters; K-Means and GMM only with `slow`, over the range."""
    drive, points = simulate(seed), {}
    for name in ("heuristic", "dbscan"):
        for distance in DISTANCES:
            points[f"{name}/distance/{distance}"] = _swept(drive, name, distance, 1, 8.0)
        for count in NEIGHBOURS:
            points[f"{name}/neighbours/{count}"] = _swept(drive, name, 0.5, count, 8.0)
        for reach in REACHES:
            points[f"{name}/range/{reach}"] = _swept(drive, name, 0.5, 1, reach)
    if slow:
        for reach in REACHES:
            scans = {i: shortened(drive.scans[i], reach) for i in drive.keys}
            for name in ("kmeans", "gmm"):
                found = cluster_by_number(name, list(scans.values()))[name]
                points[f"{name}/range/{reach}"] = _judged(drive, scans, found)
    return points


def _swept(drive: LandmarkDrive, name: str, distance: float, count: int, reach: float) -> dict[str, Any]:
    scans = {i: shortened(drive.scans[i], reach) for i in drive.keys}
    return _judged(drive, scans, cluster(name, list(scans.values()), distance, count))


def _judged(drive: LandmarkDrive, scans: Mapping[int, Any], found: Clustered) -> dict[str, Any]:
    by_number = [scans.get(i) for i in range(len(drive.scans))]
    run = run_ekf_slam(drive, "typical", by_number, found.labels)  # pyright: ignore[reportArgumentType]
    errors = errors_of(drive, run.poses)
    timing = {"cluster_ms": 1e3 * float(found.seconds.mean()), "step_ms": 1e3 * float(run.seconds.mean())}
    return {"rms_m": errors["rms_m"], "ate_m": errors["ate_m"], "timing": timing}
