"""Milliseconds of a full step: cluster, associate, update; and how they grow with the landmarks in the map."""

import copy
import time
from collections.abc import Mapping
from typing import Any

import numpy as np

from ....slam.ekf.config import EkfSlamConfig
from ....slam.ekf.engine import EkfSlam
from .drives import LandmarkDrive, simulate

SIZES = (10, 20, 100, 1000)
_STEPS, _REPEATS = 24, 3


def speed_cell(seed: int, sizes: tuple[int, ...] = SIZES) -> Mapping[str, Any]:
    """Return the milliseconds of a step of 181 beams by method and number of landmarks, all under "timing".

    After one lap the map is cut or filled up with landmarks far away to exactly as many, then 24 scans are taken in a
    row. Each counts with the best of three; the median of the scans is told.
    """
    drive, timing = simulate(seed), {}
    for method in ("heuristic", "dbscan"):
        engine = EkfSlam(EkfSlamConfig(clustering=method, travel=0.0, turn=0.0))
        stop = int(drive.keys[int(0.55 * len(drive.keys))])
        for i in drive.keys[drive.keys <= stop]:
            engine.update(drive.odometry["typical"][i], drive.scans[i])
        timing[method] = {str(size): _milliseconds(_resized(engine, size, seed), drive, stop) for size in sizes}
    return {"timing": timing}


def _resized(engine: EkfSlam, size: int, seed: int) -> EkfSlam:
    """Return a copy whose map holds `size` landmarks: its nearest ones, or more of them beyond what can be seen."""
    sized, rng = copy.deepcopy(engine), np.random.default_rng(seed)
    assert sized.filter is not None
    apart = np.hypot(*(sized.filter.landmarks - sized.filter.x[:2]).T)
    nearest = np.argsort(apart)[:size]
    sized.forget(np.setdiff1d(np.arange(len(apart)), nearest))
    for _ in range(size - len(nearest)):
        sized.learn(np.array([rng.uniform(40.0, 400.0), rng.uniform(-3.0, 3.0)]), 1e-3 * np.eye(2))
    return sized


def _milliseconds(engine: EkfSlam, drive: LandmarkDrive, start: int) -> float:
    times = np.full((_REPEATS, _STEPS), np.inf)
    for repeat in range(_REPEATS):
        trial = copy.deepcopy(engine)
        for step in range(_STEPS):
            i = start + 1 + step
            begun = time.process_time()
            trial.update(drive.odometry["typical"][i], drive.scans[i])
            times[repeat, step] = time.process_time() - begun
    return 1e3 * float(np.median(times.min(axis=0)))
