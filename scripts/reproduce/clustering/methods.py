"""The four methods, two of them with two ways to find the number of objects, and what each scan costs."""

import time
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray
from threadpoolctl import threadpool_limits

from ....slam.landmarks.clustering import (
    Dbscan,
    GaussianMixtureObjects,
    Heuristic,
    KMeansObjects,
    Labels,
)
from ....slam.scan import LaserScan

METHODS = {
    "heuristic": "heuristic",
    "kmeans": "K-Means (elbow)",
    "kmeans-silhouette": "K-Means (silhouette)",
    "gmm": "GMM (elbow)",
    "gmm-bic": "GMM (BIC)",
    "dbscan": "DBSCAN",
}
"""Key -> name in the report; the paper's four are `PAPER`."""
PAPER = ("heuristic", "kmeans", "gmm", "dbscan")


@dataclass
class Replay:
    """A clusterer that returns labels that were computed before, scan by scan.

    Attributes:
        labels: Of each scan in its turn.
    """

    labels: Sequence[Labels]
    _next: int = field(default=0, init=False)

    def fit_predict(self, points: ArrayLike) -> Labels:
        """Return the labels of the next scan; `points` are its points."""
        self._next += 1
        return self.labels[self._next - 1]


@dataclass(frozen=True, eq=False)
class Clustered:
    """What one method made of the scans.

    Attributes:
        labels: Of each scan.
        seconds: (scans,) CPU time for each, choosing the number of objects included [s].
    """

    labels: list[Labels]
    seconds: NDArray[np.float64]


def cluster(method: str, scans: Sequence[LaserScan], distance: float = 0.5, min_points: int = 1) -> Clustered:
    """Return the clusters of "heuristic" or "dbscan"; `distance` [m] and `min_points` as the method takes them."""
    if method == "heuristic":
        clusterer = Heuristic(distance=distance, min_points=min_points)
    else:
        clusterer = Dbscan(epsilon=distance, min_points=min_points)
    clusterer.fit_predict(scans[0].points)
    labels, seconds = [], []
    for scan in scans:
        points, start = scan.points, time.process_time()
        labels.append(clusterer.fit_predict(points))
        seconds.append(time.process_time() - start)
    return Clustered(labels, np.array(seconds))


def cluster_by_number(method: str, scans: Sequence[LaserScan]) -> dict[str, Clustered]:
    """Return the clusters of "kmeans" or "gmm" by both choices of the number, which share their fits, by key."""
    kind, other = (KMeansObjects, "silhouette") if method == "kmeans" else (GaussianMixtureObjects, "bic")
    ways = {method: kind(choice="elbow"), f"{method}-{other}": kind(choice=other)}
    labels: dict[str, list[Labels]] = {key: [] for key in ways}
    seconds: dict[str, list[float]] = {key: [] for key in ways}
    with threadpool_limits(1):
        ways[method].fit_predict(scans[0].points)  # scikit-learn is loaded now
        for scan in scans:
            points, start = scan.points, time.process_time()
            models = ways[method].candidates(points)
            fitting = time.process_time() - start
            for key, way in ways.items():
                start = time.process_time()
                labels[key].append(way.chosen(points, models) if models else np.zeros(len(points), dtype=np.int64))  # pyright: ignore[reportArgumentType]
                seconds[key].append(fitting + time.process_time() - start)
    return {key: Clustered(labels[key], np.array(seconds[key])) for key in ways}
