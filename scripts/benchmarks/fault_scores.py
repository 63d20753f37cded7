"""Whether an engine says so when it is wrong: stretches in which its pose is off, and its opinion of itself then."""

from dataclasses import asdict, dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ...slam.geometry import transform_points
from ...slam.quality.rigid import fit_rigid

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

OFF = 1.0
"""A pose that is farther from the truth than this is off [m]."""
STRETCH = 50
"""So many scans in a row that are off make a stretch that an honest engine tells."""
_ROUNDS = 50  # of the alignment; it settles in fewer
_LEAST = 0.01  # distance up to which all count alike [m]


@dataclass(frozen=True)
class Honesty:
    """What an engine thought of itself along a drive.

    Attributes:
        located: Share of scans in which it said that it knew where it was.
        off: Share of scans whose online pose was off.
        stretches: How many stretches of at least `STRETCH` scans were off.
        told: In how many of them it said at some scan that it did not know.
        wrongly_told: Share of scans in which it said so although its pose was right.
    """

    located: float
    off: float
    stretches: int
    told: int
    wrongly_told: float

    def to_dict(self) -> dict[str, float]:
        """Return the fields by name."""
        return asdict(self)


def honesty(online: Array, located: Flags, truth: Array) -> Honesty:
    """Compare the online poses (n, 3) of an engine and its `located` (n,) with the truth (n, 3)."""
    off = aligned_distances(online, truth) > OFF
    stretches = off_stretches(off)
    told = sum(bool((~located[start:end]).any()) for start, end in stretches)
    return Honesty(float(located.mean()), float(off.mean()), len(stretches), told, float((~located & ~off).mean()))


def aligned_distances(poses: Array, truth: Array) -> Array:
    """Return (n,) how far positions are from the true ones, laid on them with the least sum of distances [m].

    The rigid motion of least squares (as for the ATE) would be drawn away from what is right by a part that is far off.
    """
    weights, distances = np.ones(len(poses)), np.zeros(len(poses))
    for _ in range(_ROUNDS):  # least squares, weighted anew (Weiszfeld 1937)
        T_truth_map = fit_rigid(poses[:, :2], truth[:, :2], weights)
        distances = np.linalg.norm(transform_points(T_truth_map, poses[:, :2]) - truth[:, :2], axis=1)
        weights = 1.0 / np.maximum(distances, _LEAST)
    return distances


def off_stretches(off: Flags) -> list[tuple[int, int]]:
    """Return where `off` (n,) is true for at least `STRETCH` scans: (first, behind the last)."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], off, [False])).astype(np.int8)))
    return [(start, end) for start, end in list(pairwise(edges.tolist()))[::2] if end - start >= STRETCH]
