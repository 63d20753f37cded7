"""Pairs of scans with a known transform, by the protocol of Cuzzocrea et al. 2022, section 3."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...slam.geometry import transform_points
from ...slam.logs.carmen import read_carmen
from ...slam.scan import LaserScan

# name of a building -> its log in the folder of the logs
LOGS = {
    "intel": "intel_every5th.log.gz",
    "belgioioso": "belgioioso_with_odometry.log.gz",
    "sena": "sena_one_loop.log.gz",
    "aces": "aces_with_odometry.log.gz",
    "orebro": "orebro-corrected.log.gz",
    "seattle": "seattle-corrected.log.gz",
    "acapulco": "acapulco-corrected.log.gz",
}
# Neighbouring beams of a SICK scan of 360 or 361 beams come from two turns of its mirror, 13 ms apart.
_TWO_TURNS = 300


@dataclass(frozen=True, eq=False)
class Trial:
    """One question to a matcher.

    Attributes:
        reference: The reference scan.
        new: The new scan, in a frame of its own.
        guess: (3,) what the matcher is told [m, m, rad].
        truth: (3,) the pose of the new scan in the reference's frame.
    """

    reference: LaserScan
    new: LaserScan
    guess: NDArray[np.float64]
    truth: NDArray[np.float64]


def split_scan(scan: LaserScan) -> tuple[LaserScan, LaserScan]:
    """Return (odd readings, even readings) of a scan, both of one turn of the mirror."""
    if len(scan) > _TWO_TURNS:
        scan = every(scan, 2, 0)
    return every(scan, 2, 0), every(scan, 2, 1)


def every(scan: LaserScan, step: int, first: int) -> LaserScan:
    """Return the scan of every `step`-th beam from `first`."""
    return replace(scan, ranges=scan.ranges[first::step].copy(), bearings=scan.bearings[first::step].copy())


def read_scans(folder: Path, building: str, least_returns: int = 60) -> list[LaserScan]:
    """Return the scans of a building's log with at least `least_returns` returns a half."""
    scans = read_carmen(folder / LOGS[building]).scans
    near = [scan for scan in scans if all(part.is_return.sum() >= least_returns for part in split_scan(scan))]
    return near


def split_trials(scans: list[LaserScan], count: int, translation: float, rotation: float, seed: int) -> list[Trial]:
    """Return `count` trials: odd readings against even ones, the guess off by `translation` [m] and `rotation` [rad].

    The translation is laid on a diagonal (the paper's 0.57 = 0.4 sqrt 2, 2.12 = 1.5 sqrt 2), of the four one at
    random, the rotation to either side; `nan`: a random one of the full circle.
    """
    rng = np.random.default_rng(seed)
    trials = []
    for index in rng.integers(len(scans), size=count):
        reference, new = split_scan(scans[index])
        offset = rng.choice([-1.0, 1.0], size=2) * translation / np.sqrt(2.0)
        turn = rng.uniform(-np.pi, np.pi) if np.isnan(rotation) else rng.choice([-1.0, 1.0]) * rotation
        trials.append(Trial(reference, new, np.array([*offset, turn]), np.zeros(3)))
    return trials


def is_success(error: NDArray[np.float64], linear: float = 0.10, angular: float = 0.01) -> NDArray[np.bool_]:
    """Return whether errors (..., 3) lie in the ellipsoid of half axes `linear` [m] and `angular` [rad]."""
    return (error[..., :2] ** 2).sum(axis=-1) / linear**2 + (error[..., 2] / angular) ** 2 <= 1.0


def moved_points(scan: LaserScan, pose: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the returns of a scan at a pose."""
    return transform_points(pose, scan.points)
