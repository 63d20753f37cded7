"""Pairs of scans with a known transform, by the protocol of Cuzzocrea et al. 2022, section 3."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...envs.simulation2d.furnished_buildings import draw_building
from ...envs.simulation2d.outlines import Outlines, cast
from ...slam.geometry import between
from ...slam.logs.carmen import read_carmen
from ...slam.scan import LaserScan
from ...slam.scan_to_scan.confidence import LONG_LINES
from ...slam.scan_to_scan.surfaces import find_surfaces

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
# logs whose poses serve as reference
VIEWS = {"intel": "intel.gfs.log.gz", "aces": "aces_with_odometry.log.gz"}
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


@lru_cache(maxsize=16)
def read_scans(folder: Path, building: str, least_returns: int = 60) -> list[LaserScan]:
    """Return the scans of a building's log with at least `least_returns` returns a half."""
    return _full(read_carmen(folder / LOGS[building]).scans, least_returns)


@lru_cache(maxsize=4)
def simulated_scans(count: int = 400, noise: float = 0.01, least_returns: int = 60) -> list[LaserScan]:
    """Return scans of random furnished buildings: 180 beams of 1 degree, 30 m, `noise` [m]."""
    rng = np.random.default_rng(0)
    bearings = np.radians(np.arange(-90.0, 90.0))
    scans = []
    for _ in range(count):
        ranges, _ = cast(np.zeros((180, 2)), bearings, 30.0, *draw_building(rng, rng.uniform(3.0, 8.0)).arrays())
        scans.append(LaserScan(ranges + rng.normal(0.0, noise, 180), bearings, 0.05, 30.0))
    return _full(scans, least_returns)


def _full(scans: Sequence[LaserScan], least_returns: int) -> list[LaserScan]:
    return [scan for scan in scans if all(part.is_return.sum() >= least_returns for part in split_scan(scan))]


def split_trials(
    scans: Sequence[LaserScan],
    count: int,
    translation: float,
    rotation: float,
    seed: int,
    *,
    noise: float = 0.0,
    people: int = 0,
) -> list[Trial]:
    """Return `count` trials: odd readings against even ones, the guess off by `translation` [m] and `rotation` [rad].

    The translation is laid on a diagonal (the paper's 0.57 = 0.4 sqrt 2, 2.12 = 1.5 sqrt 2), of the four one at
    random, the rotation to either side; `nan`: a random one of the full circle.

    Args:
        scans: What is drawn from, each once before any comes again.
        count: How many trials.
        translation: Of the guess's error [m].
        rotation: Of the guess's error [rad].
        seed: Decides the scans, the sides, the noise and the people.
        noise: Standard deviation of what is added to every range [m].
        people: How many walk before the laser; between the two scans each goes on by half a metre.
    """
    rng = np.random.default_rng(seed)
    disturbance = np.random.default_rng((seed, 1))
    trials = []
    for index in _draw(len(scans), count, rng):
        reference, new = _halves(scans[index], noise, people, disturbance)
        offset = rng.choice([-1.0, 1.0], size=2) * translation / np.sqrt(2.0)
        turn = rng.uniform(-np.pi, np.pi) if np.isnan(rotation) else rng.choice([-1.0, 1.0]) * rotation
        trials.append(Trial(reference, new, np.array([*offset, turn]), np.zeros(3)))
    return trials


def box_trials(scans: Sequence[LaserScan], count: int, linear: float, angular: float, seed: int) -> list[Trial]:
    """Return `count` trials, the guess off by anything of the box +-`linear` [m], +-`angular` [rad], evenly drawn."""
    rng = np.random.default_rng(seed)
    trials = []
    for index in rng.integers(len(scans), size=count):
        guess = rng.uniform(-1.0, 1.0, 3) * (linear, linear, angular)
        trials.append(Trial(*split_scan(scans[index]), guess, np.zeros(3)))
    return trials


def _draw(of: int, count: int, rng: np.random.Generator) -> NDArray[np.int64]:
    """Return `count` indices below `of`, each once in every round."""
    rounds = [rng.permutation(of) for _ in range(-(-count // of))] if of > 0 else []
    return np.concatenate([np.empty(0, dtype=np.int64), *rounds])[:count]


def _halves(scan: LaserScan, noise: float, people: int, rng: np.random.Generator) -> tuple[LaserScan, LaserScan]:
    before = after = scan
    if people > 0:
        bearing = rng.choice(scan.bearings[scan.is_return], people)
        behind = np.interp(bearing, scan.bearings, np.where(scan.is_return, scan.ranges, scan.range_max))
        distance = rng.uniform(1.0, np.clip(behind - 0.2, 1.1, 5.0))
        place = distance[:, None] * np.stack((np.cos(bearing), np.sin(bearing)), axis=-1)
        heading = rng.uniform(-np.pi, np.pi, people)
        step = 0.5 * np.stack((np.cos(heading), np.sin(heading)), axis=-1)
        step *= np.where(np.hypot(*(place + step).T) < 0.8, -1.0, 1.0)[:, None]
        before, after = with_people(scan, place, heading), with_people(scan, place + step, heading)
    reference, new = split_scan(before)[0], split_scan(after)[1]
    if noise > 0.0:
        reference, new = (
            replace(half, ranges=np.maximum(half.ranges + rng.normal(0.0, noise, len(half)), half.range_min))
            for half in (reference, new)
        )
    return reference, new


def with_people(scan: LaserScan, places: NDArray[np.float64], headings: NDArray[np.float64]) -> LaserScan:
    """Return the scan with people in it: two legs of 14 cm each, 25 cm apart across `headings` (n,), at `places`."""
    outlines = Outlines()
    across = np.stack((-np.sin(headings), np.cos(headings)), axis=-1)
    for place, side in zip(places, across, strict=True):
        for foot in (-0.125, 0.125):
            outlines.ellipse(place + foot * side, 0.07, 0.07)
    ranges, _ = cast(np.zeros((len(scan), 2)), scan.bearings, scan.range_max, *outlines.arrays())
    return replace(scan, ranges=np.where(np.isfinite(ranges), np.fmin(ranges, scan.ranges), scan.ranges))


def blind_direction(scan: LaserScan, share: float = 0.05) -> NDArray[np.float64] | None:
    """Return the unit vector (2,) along the corridor that a scan was taken in; None: it was not.

    In a corridor the walls' normals have less than `share` of their sum of squares in one direction.
    """
    normals = find_surfaces(split_scan(scan)[0], LONG_LINES).normals
    values, vectors = np.linalg.eigh(normals.T @ normals)
    return vectors[:, 0] if values[0] < share * values.sum() else None


@lru_cache(maxsize=8)
def view_pairs(
    folder: Path, building: str, turns: tuple[float, float], distances: tuple[float, float], count: int, seed: int
) -> list[Trial]:
    """Return pairs of scans of a log whose poses are known, the guess off by up to 1 m in x and y and any heading.

    Args:
        folder: Of the logs.
        building: A log with corrected poses, see `VIEWS`.
        turns: The headings differ by this much (from, to) [rad].
        distances: The places differ by this much (from, to) [m].
        count: How many pairs.
        seed: Decides which, and the guesses.
    """
    drive = read_carmen(folder / VIEWS[building])
    poses = drive.odometry if drive.reference is None else drive.reference
    rng = np.random.default_rng(seed)
    good = np.array([k for k, scan in enumerate(drive.scans) if scan.is_return.sum() >= 100])
    trials: list[Trial] = []
    for _ in range(20 * count):
        first = rng.choice(good)
        relative = between(poses[first], poses[good])
        turn, distance = np.abs(relative[:, 2]), np.hypot(relative[:, 0], relative[:, 1])
        fits = (turns[0] <= turn) & (turn < turns[1]) & (distances[0] <= distance) & (distance < distances[1])
        choice = np.flatnonzero(fits & (good != first))
        if len(choice) > 0:
            pick = rng.choice(choice)
            error = rng.uniform(-1.0, 1.0, 3) * (1.0, 1.0, np.pi)
            trials.append(Trial(drive.scans[first], drive.scans[good[pick]], relative[pick] + error, relative[pick]))
        if len(trials) == count:
            break
    return trials


def is_success(error: NDArray[np.float64], linear: float = 0.10, angular: float = 0.01) -> NDArray[np.bool_]:
    """Return whether errors (..., 3) lie in the ellipsoid of half axes `linear` [m] and `angular` [rad]."""
    return (error[..., :2] ** 2).sum(axis=-1) / linear**2 + (error[..., 2] / angular) ** 2 <= 1.0
