"""A cell of scans that say little or nothing: no matcher may be confidently wrong about them."""

from typing import Any

import numpy as np

from ....envs.simulation2d.outlines import Outlines, cast
from ....slam.geometry import between, compose
from ....slam.scan import LaserScan
from .contestants import make_contestant

_BEARINGS = np.radians(np.arange(-180.0, 180.0))
KINDS = ("empty", "three points", "NaN", "all too near", "all at the farthest range", "corridor", "one wall")


def degenerate(matcher: str, trials: int) -> dict[str, Any]:
    """Return, for each kind, how many answers were believed, and how many of those blind, how many confidently wrong.

    Blind: the covariance says that a direction is open (`Match.is_blind`), which is so for all kinds.
    Confidently wrong: believed, and off by more than three standard deviations of the answer's own covariance plus
    0.10 m and 0.02 rad, in the direction where the error is.
    """
    tool, rng, counts = make_contestant(matcher), np.random.default_rng(0), {}
    for kind in KINDS:
        believed, blind, wrong, finite = 0, 0, 0, 0
        for _ in range(trials):
            at = np.array([*rng.uniform(-0.4, 0.4, 2), rng.uniform(-np.pi, np.pi)])
            moved = compose(at, [*rng.uniform(-0.1, 0.1, 2), rng.uniform(-0.1, 0.1)])
            reference, new = (_scan(kind, pose, rng) for pose in (at, moved))
            truth = between(at, moved)
            match = tool.match(reference, new, truth + rng.uniform(-0.05, 0.05, 3))
            error = match.pose - truth
            error[2] = (error[2] + np.pi) % (2 * np.pi) - np.pi
            bound = 3.0 * np.sqrt(np.diag(match.covariance)) + (0.10, 0.10, 0.02)
            believed += match.converged
            blind += match.converged and match.is_blind
            wrong += match.converged and bool((np.abs(error) > bound).any())
            finite += bool(np.isfinite(match.pose).all() and np.isfinite(match.covariance).all())
        counts[kind] = {"believed": believed, "blind": blind, "confidently_wrong": wrong, "finite": finite}
    return {"trials": trials, "kinds": counts}


def _scan(kind: str, pose: np.ndarray, rng: np.random.Generator) -> LaserScan:
    ranges = np.full(360, np.inf)
    if kind == "three points":
        ranges[rng.integers(360, size=3)] = rng.uniform(1.0, 5.0, 3)
    elif kind == "NaN":
        ranges[:] = np.nan
    elif kind == "all too near":
        ranges[:] = 0.0
    elif kind == "all at the farthest range":
        ranges[:] = 20.0
    elif kind in ("corridor", "one wall"):
        walls = Outlines()
        for y in (-1.2, 1.2)[: 2 if kind == "corridor" else 1]:
            walls.segment(np.array([-100.0, y]), np.array([100.0, y]))
        ranges, _ = cast(np.tile(pose[:2], (360, 1)), _BEARINGS + pose[2], 20.0, *walls.arrays())
        ranges = ranges + rng.normal(0.0, 0.01, 360)
    return LaserScan(ranges, _BEARINGS, 0.05, 20.0)
