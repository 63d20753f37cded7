"""From a scan to the legs in it: clusters, features, forest."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ...slam.bounds import check_numbers
from ...slam.errors import InputError
from ...slam.scan import LaserScan
from .centres_kernel import leg_centres_of
from .clusters import DEFAULT_ALPHA, DEFAULT_BETA, Clusters
from .detection_kernel import Beams, Splitting, find_legs
from .features import beam_spacing
from .forest import LegForest


@dataclass(frozen=True, kw_only=True)
class LegDetectorConfig:
    """Parameters of the leg detector (paper, Table II)."""

    alpha: float = DEFAULT_ALPHA
    """Largest distance between neighbouring points of a cluster [m]."""
    beta: int = DEFAULT_BETA
    """Smallest number of points of a cluster."""
    gamma: float = 0.3
    """Clusters with less confidence are not human."""
    far_width: float = 0.0
    """Where a leg of this width gets fewer than `beta` beams, as many are enough, but at least 2; 0: never [m]."""

    def __post_init__(self) -> None:
        check_numbers(self)
        if not (self.alpha > 0.0 and self.beta >= 1 and 0.0 <= self.gamma <= 1.0 and self.far_width >= 0.0):
            raise InputError(
                f"need `alpha` > 0 [m], `beta` >= 1, `gamma` in [0, 1] and `far_width` >= 0 [m], got {self}"
            )


@dataclass(frozen=True, eq=False)
class Detections:
    """All clusters of one scan, and how much each looks like a leg.

    Attributes:
        positions: (m, 2) centre of the leg that would show such an arc, in the robot frame [m].
        confidence: (m,) in [0, 1].
        human: (m,) whether the confidence reaches gamma; the others mark the local grid as not human.
        clusters: The clusters themselves (laser frame).
    """

    positions: NDArray[np.float64]
    confidence: NDArray[np.float64]
    human: NDArray[np.bool_]
    clusters: Clusters

    def __len__(self) -> int:
        return len(self.positions)


def no_detections() -> Detections:
    """Return that nothing at all was found."""
    none = np.zeros(0, dtype=np.int64)
    clusters = Clusters(np.empty((0, 2)), none, none, none)
    return Detections(np.empty((0, 2)), np.empty(0), np.zeros(0, dtype=bool), clusters)


class Detector(Protocol):
    """Finds legs in one scan."""

    def detect(self, scan: LaserScan) -> Detections:
        """Return the clusters of `scan` with their confidence, positions in the robot frame."""
        ...


class LegDetector:
    """Finds legs in single scans."""

    def __init__(self, forest: LegForest, config: LegDetectorConfig | None = None) -> None:
        self.forest = forest
        self.config = config or LegDetectorConfig()

    def detect(self, scan: LaserScan) -> Detections:
        """Return the clusters of `scan` with their confidence and leg centres."""
        beams = beams_of(scan)
        found = find_legs(scan.ranges, beams, splitting(self.config, beams), self.forest.packed)
        clusters = Clusters(found.points, found.numbers, found.start, found.end)
        return Detections(found.positions, found.confidence, found.human, clusters)


def beams_of(scan: LaserScan) -> Beams:
    """Return what all sweeps of the laser that took `scan` have in common, as kernels take it."""
    limits, mount = (float(scan.range_min), float(scan.range_max)), np.asarray(scan.T_robot_lidar, dtype=np.float64)
    return Beams(scan.bearings, scan.directions, *limits, mount, beam_spacing(scan))


def splitting(config: LegDetectorConfig, beams: Beams) -> Splitting:
    """Return the numbers of `config` as kernels take them, for a laser with `beams`."""
    width = float(config.far_width) if len(beams.bearings) > 1 else 0.0
    return Splitting(float(config.alpha), int(config.beta), float(config.gamma), width / beams.spacing)


def leg_centres(clusters: Clusters) -> NDArray[np.float64]:
    """Return (m, 2) mean points moved away from the laser to the centre of a leg as wide as the cluster [m].

    A circle fitted to a few noisy points of an arc is off by decimetres; the width across the line of sight is known
    to a beam spacing. Beams at equal angles meet a circle of radius r at a mean depth of pi/4 r before its centre.
    Clusters wider than one leg (both legs, a skirt) are moved as far as the widest single leg.
    """
    return leg_centres_of(clusters.points, clusters.start, clusters.end)
