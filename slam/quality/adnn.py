"""Average distance to the nearest neighbour (ADNN) between two maps, Ye et al. 2021, equation 7."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from sklearn.neighbors import NearestNeighbors

from ..bounds import check_points
from ..errors import InputError


@dataclass(frozen=True)
class NearestDistances:
    """How far the occupied cells of one map lie from the nearest occupied cell of another, over all its cells.

    Attributes:
        mean_m: Their mean [m]: the ADNN.
        max_m: The largest [m].
        min_m: The smallest [m].
        std_m: Their standard deviation [m].
        cells: How many cells were asked (the N of equation 7).
    """

    mean_m: float
    max_m: float
    min_m: float
    std_m: float
    cells: int


def nearest_distances(from_points: NDArray[np.float64], to_points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (N,) distances [m] from each of `from_points` (N, 2) to the nearest of `to_points` (M, 2).

    Raises:
        InputError: If one of the sets is empty: there is no nearest neighbour then.
    """
    if len(from_points) == 0 or len(to_points) == 0:
        raise InputError(
            f"nearest neighbours need occupied cells in both maps, got {len(from_points)} and {len(to_points)}"
        )
    for name, points in (("from_points", from_points), ("to_points", to_points)):
        check_points(points, name)
    search = NearestNeighbors(n_neighbors=1, algorithm="kd_tree").fit(to_points)
    distances, _ = search.kneighbors(from_points)
    return np.asarray(distances[:, 0], dtype=np.float64)


def adnn(estimate_points: NDArray[np.float64], reference_points: NDArray[np.float64]) -> NearestDistances:
    """Return equation 7: the mean over the *reference*'s occupied cells of the distance to the nearest estimated one.

    It grows with walls that are missing or displaced, and does not see ghosts: cells that only the estimate has. For
    those ask the other way round, `adnn(reference_points, estimate_points)`.

    Args:
        estimate_points: (M, 2) occupied cells of the estimated map, already registered [m].
        reference_points: (N, 2) occupied cells of the ground-truth map, same frame [m].

    Raises:
        InputError: If a map has no occupied cell.
    """
    distances = nearest_distances(reference_points, estimate_points)
    return NearestDistances(
        float(distances.mean()), float(distances.max()), float(distances.min()), float(distances.std()), len(distances)
    )
