"""How many labelled legs a forest finds, against how many false ones it sees where nobody is."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from ...perception.legs.clusters import cluster_scan
from ...perception.legs.detector import leg_centres
from ...perception.legs.forest import LegForest
from ...slam.errors import InputError
from ...slam.scan import LaserScan
from .leg_recordings import LegRecording
from .leg_samples import LEG_SHARE, OTHER_SHARE
from .leg_scans import LabelledScan

MATCH_DISTANCE = 0.2
FARTHEST_LEG = 5.0
FARTHEST_SIMULATED_LEG = 6.0
RATES = (0.1, 0.25, 0.5, 1.0, 2.0, 4.0)
GAP = 15  # scans (2 s) left out between the trained and the tested part of the people-free recording


@dataclass(frozen=True, eq=False)
class LegScores:
    """Confidences of labelled legs, and of clusters where nobody is.

    Attributes:
        legs: (n,) confidence of the cluster matched to each labelled leg, 0 where none is.
        false: (k,) confidence of every cluster in people-free scans.
        scans: Number of people-free scans.
    """

    legs: NDArray[np.float64]
    false: NDArray[np.float64]
    scans: int

    @classmethod
    def joined(cls, parts: Sequence["LegScores"]) -> "LegScores":
        """Return the scores of all parts."""
        return cls(
            np.concatenate([p.legs for p in parts]),
            np.concatenate([p.false for p in parts]),
            sum(p.scans for p in parts),
        )

    def threshold(self, rate: float) -> float:
        """Return the confidence that at most `rate` false legs a people-free scan exceed."""
        allowed = int(rate * self.scans)
        return float(np.sort(self.false)[::-1][allowed]) if allowed < len(self.false) else 0.0

    def recall(self, rate: float) -> float:
        """Return the share of labelled legs found at `rate` false legs a people-free scan."""
        return float((self.legs > self.threshold(rate)).mean())

    def at(self, gamma: float) -> tuple[float, float]:
        """Return recall and false legs a people-free scan at a confidence of `gamma`."""
        return float((self.legs >= gamma).mean()), float((self.false >= gamma).sum() / max(self.scans, 1))


def score_legs(forest: LegForest, recordings: Sequence[LegRecording], people_free: Sequence[LaserScan]) -> LegScores:
    """Score `forest` on recordings that it was not trained on.

    A leg within 5 m counts as found by at most one cluster within 0.2 m, and a cluster finds at most one leg.
    """
    legs = [np.empty(0)]
    for recording in recordings:
        for scan, places in zip(recording.scans, recording.legs, strict=True):
            near = places[np.hypot(places[:, 0], places[:, 1]) <= FARTHEST_LEG]
            legs.append(_match(forest, scan, near))
    false = [np.empty(0), *(forest.confidence(scan, cluster_scan(scan)) for scan in people_free)]
    return LegScores(np.concatenate(legs), np.concatenate(false), len(people_free))


def score_labelled(forest: LegForest, labelled: Sequence[LabelledScan]) -> LegScores:
    """Score `forest` on scans whose every beam is known; people and other things in the same scans.

    A cluster is a leg if most of its points are, and counts within 6 m.
    """
    legs, false = [np.empty(0)], [np.empty(0)]
    for drawn in labelled:
        clusters = cluster_scan(drawn.scan)
        confidence = forest.confidence(drawn.scan, clusters)
        hits = np.concatenate(([0], np.cumsum(drawn.is_leg[clusters.beams])))
        share = (hits[clusters.end] - hits[clusters.start]) / clusters.sizes
        near = np.hypot(*clusters.centres.T) <= FARTHEST_SIMULATED_LEG
        legs.append(confidence[(share >= LEG_SHARE) & near])
        false.append(confidence[share <= OTHER_SHARE])
    return LegScores(np.concatenate(legs), np.concatenate(false), len(labelled))


def _match(forest: LegForest, scan: LaserScan, legs: NDArray[np.float64]) -> NDArray[np.float64]:
    clusters = cluster_scan(scan)
    confidence = forest.confidence(scan, clusters)
    away = np.hypot(*(leg_centres(clusters)[:, None] - legs[None]).transpose(2, 0, 1))
    gain = np.where(away <= MATCH_DISTANCE, confidence[:, None] + 1e-3 * (MATCH_DISTANCE - away), 0.0)
    found = np.zeros(len(legs))
    for cluster, leg in zip(*linear_sum_assignment(gain, maximize=True), strict=True):
        if away[cluster, leg] <= MATCH_DISTANCE:
            found[leg] = confidence[cluster]
    return found


def cross_validate(
    train: Callable[[list[LegRecording], list[LaserScan]], LegForest],
    positive: Sequence[LegRecording],
    people_free: Sequence[LaserScan],
) -> list[tuple[LegForest, LegRecording, list[LaserScan], LegScores]]:
    """Leave one recording out, and one block of the people-free scans: (forest, recording, block, scores) of each fold.

    `train` gets the other recordings, and the people-free scans outside the block and 2 s on both sides of it.

    Raises:
        InputError: If the people-free scans are too few.
    """
    if len(people_free) < 2 * (GAP + 1) * len(positive):
        raise InputError(f"the people-free recording is too short to leave parts of it out: {len(people_free)} scans")
    blocks = np.array_split(np.arange(len(people_free)), len(positive))
    folds = []
    for held_out, block in zip(positive, blocks, strict=True):
        others = [r for r in positive if r is not held_out]
        outside = [s for i, s in enumerate(people_free) if not block[0] - GAP <= i <= block[-1] + GAP]
        inside = [people_free[i] for i in block]
        forest = train(others, outside)
        folds.append((forest, held_out, inside, score_legs(forest, [held_out], inside)))
    return folds
