"""Training samples: the features of clusters, and whether they are legs."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray
from tqdm import tqdm

from ...perception.legs.clusters import cluster_scan
from ...perception.legs.features import FEATURE_NAMES, cluster_features
from ...slam.scan import LaserScan
from .leg_scans import draw_scan

LABEL_DISTANCE = 0.1  # a labelled leg belongs to the cluster with a mean this near [m]
LEG_SHARE, OTHER_SHARE = 0.7, 0.2  # clusters with a share of leg points in between teach nothing


@dataclass(frozen=True, eq=False)
class Samples:
    """Clusters to learn from.

    Attributes:
        features: (n, F).
        is_leg: (n,).
    """

    features: NDArray[np.float32]
    is_leg: NDArray[np.bool_]

    @classmethod
    def joined(cls, parts: Sequence["Samples"]) -> "Samples":
        """Return all samples of `parts`."""
        return cls(np.concatenate([p.features for p in parts]), np.concatenate([p.is_leg for p in parts]))

    @classmethod
    def none(cls) -> "Samples":
        """Return no samples."""
        return cls(np.empty((0, len(FEATURE_NAMES)), np.float32), np.empty(0, np.bool_))


def simulated_samples(rng: Generator, scans: int) -> Samples:
    """Return the clusters of `scans` simulated scans."""
    parts = [Samples.none()]
    for _ in tqdm(range(scans), desc="simulated scans", leave=False, disable=None):
        drawn = draw_scan(rng)
        parts.append(samples_of(drawn.scan, drawn.is_leg))
    return Samples.joined(parts)


def samples_of(scan: LaserScan, is_leg: NDArray[np.bool_]) -> Samples:
    """Return the clusters of a scan of which each beam's truth `is_leg` (N,) is known."""
    clusters = cluster_scan(scan)
    hits = np.concatenate(([0], np.cumsum(is_leg[clusters.beams])))
    share = (hits[clusters.end] - hits[clusters.start]) / clusters.sizes
    features = cluster_features(scan, clusters)
    clear = ((share >= LEG_SHARE) | (share <= OTHER_SHARE)) & ~np.isnan(features[:, 0])
    return Samples(features[clear], share[clear] >= LEG_SHARE)


def labelled_samples(scans: Sequence[LaserScan], legs: Sequence[NDArray[np.float64]]) -> Samples:
    """Return the clusters at labelled legs (n, 2) of each scan; the others are not known and left out."""
    parts = [Samples.none()]
    for scan, places in zip(scans, legs, strict=True):
        clusters = cluster_scan(scan)
        features = cluster_features(scan, clusters)
        away = np.hypot(*(clusters.centres[:, None] - places[None]).transpose(2, 0, 1))
        found = (away.min(axis=1, initial=np.inf) < LABEL_DISTANCE) & ~np.isnan(features[:, 0])
        parts.append(Samples(features[found], np.ones(found.sum(), np.bool_)))
    return Samples.joined(parts)


def people_free_samples(scans: Sequence[LaserScan]) -> Samples:
    """Return all clusters of scans without people."""
    return Samples.joined([Samples.none(), *(samples_of(scan, np.zeros(len(scan), np.bool_)) for scan in scans)])
