"""Four ways to say which points of a scan belong to one object, behind one verb `fit_predict` (Urvina et al. 2023).

K-Means and the Gaussian mixture are scikit-learn's; the heuristic cut and DBSCAN are compiled here, with numpy and
scikit-learn as oracles in the tests. A comparison of their times is one of these implementations, not of the methods.

Equations of the paper that are printed wrongly, and what is meant: eq. 1 prints the distance between an object and the
robot, where the text compares consecutive points; eq. 2 and 4 have p_1 for p_i; eq. 12 is a scalar variance, where the
mixture needs a full covariance matrix: sum of gamma (x - mu)(x - mu)^T over sum of gamma.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..bounds import Reach, Seed, Within, check_numbers
from ..errors import InputError, unknown_name
from .dbscan_kernel import dbscan_labels
from .heuristic_kernel import heuristic_labels

if TYPE_CHECKING:  # scikit-learn takes seconds to load: only the methods that need it do
    from sklearn.cluster import KMeans
    from sklearn.mixture import GaussianMixture

Labels = NDArray[np.int64]


class Clusterer(Protocol):
    """Gives each point the number of its object."""

    def fit_predict(self, points: ArrayLike) -> Labels:
        """Return (n,) the cluster of each of `points` (n, 2) [m], in beam order; -1: none."""
        ...


@dataclass(frozen=True, kw_only=True)
class Heuristic:
    """Cuts the sweep wherever two consecutive points are far apart (eq. 1 as the text says it).

    Attributes:
        distance: Points further apart than this belong to two objects [m].
        min_points: Objects of fewer points are noise.
    """

    distance: Reach = 0.5
    min_points: int = 1

    def __post_init__(self) -> None:
        check_numbers(self)
        _check(self.distance, self.min_points)

    def fit_predict(self, points: ArrayLike) -> Labels:
        """Return (n,) the cluster of each of `points` (n, 2) [m], in beam order; -1: fewer than `min_points`."""
        return heuristic_labels(_points(points), self.distance, self.min_points)


@dataclass(frozen=True, kw_only=True)
class Dbscan:
    """Density based clustering (eq. 13).

    Attributes:
        epsilon: Points within this are neighbours [m].
        min_points: So many neighbours, itself included, make a point a core point.
    """

    epsilon: Reach = 0.5
    min_points: int = 1

    def __post_init__(self) -> None:
        check_numbers(self)
        _check(self.epsilon, self.min_points)

    def fit_predict(self, points: ArrayLike) -> Labels:
        """Return (n,) the cluster of each of `points` (n, 2) [m]; -1: noise."""
        return dbscan_labels(_points(points), self.epsilon, self.min_points)


@dataclass(frozen=True, kw_only=True)
class KMeansObjects:
    """K-Means (eq. 2-4), the number of objects found by trying 1 to `most`.

    Attributes:
        most: The largest number tried.
        choice: "elbow" as in the paper, or "silhouette".
        seed: Of the first centroids.
    """

    most: Annotated[int, Within(1, 100)] = 12
    choice: str = "elbow"
    seed: Seed = 0

    def __post_init__(self) -> None:
        check_numbers(self)
        _check_choice(self.most, self.choice, ("elbow", "silhouette"))

    def fit_predict(self, points: ArrayLike) -> Labels:
        """Return (n,) the cluster of each of `points` (n, 2) [m]."""
        array = _points(points)
        models = self.candidates(array)
        return self.chosen(array, models) if models else np.zeros(len(array), dtype=np.int64)

    def candidates(self, points: NDArray[np.float64]) -> "list[KMeans]":
        """Return a fit to `points` (n, 2) for each number of objects from 1 on; none where points do not differ."""
        most = min(self.most, len(np.unique(points, axis=0)))
        return [] if most <= 1 else [self._fit(points, k) for k in range(1, most + 1)]

    def chosen(self, points: NDArray[np.float64], models: "list[KMeans]") -> Labels:
        """Return the labels (n,) of that of `models` which `choice` takes."""
        if self.choice == "elbow":
            best = elbow(np.array([model.inertia_ for model in models], dtype=np.float64))
        else:
            best = _best_silhouette(points, [np.asarray(model.labels_) for model in models])
        return np.asarray(models[best].labels_, dtype=np.int64)

    def _fit(self, points: NDArray[np.float64], k: int) -> "KMeans":
        from sklearn.cluster import KMeans

        return KMeans(k, n_init="auto", random_state=self.seed).fit(points)


@dataclass(frozen=True, eq=False)
class Mixture:
    """A Gaussian mixture that was fitted to points.

    Attributes:
        weights: (k,) of the components; they sum to 1.
        means: (k, 2) [m].
        covariances: (k, 2, 2) [m^2].
        labels: (n,) the likeliest component of each point.
    """

    weights: NDArray[np.float64]
    means: NDArray[np.float64]
    covariances: NDArray[np.float64]
    labels: Labels


@dataclass(frozen=True, kw_only=True)
class GaussianMixtureObjects:
    """Gaussian mixture by EM (eq. 5-12) with full covariances, the number of objects found by trying 1 to `most`.

    Attributes:
        most: The largest number tried.
        choice: "elbow" (of the negative log-likelihood) as in the paper, or "bic".
        seed: Of the first means.
        floor: Smallest variance, added to each covariance [m^2].
    """

    most: Annotated[int, Within(1, 100)] = 12
    choice: str = "elbow"
    seed: Seed = 0
    floor: float = 1e-4

    def __post_init__(self) -> None:
        check_numbers(self)
        _check_choice(self.most, self.choice, ("elbow", "bic"))
        if not self.floor > 0.0:
            raise InputError(f"`floor` must be positive [m^2], got {self.floor}")

    def fit_predict(self, points: ArrayLike) -> Labels:
        """Return (n,) the likeliest component of each of `points` (n, 2) [m].

        The mixture's own means and covariances are not used for the objects: `describe_objects` takes those of the
        points, as for the other methods, so that only the grouping differs. `fit` returns them.
        """
        array = _points(points)
        models = self.candidates(array)
        return self.chosen(array, models) if models else np.zeros(len(array), dtype=np.int64)

    def fit(self, points: ArrayLike) -> Mixture:
        """Return the mixture that `choice` takes for `points` (n, 2) [m] (eq. 5-12).

        Raises:
            InputError: If no two of the points differ.
        """
        array = _points(points)
        models = self.candidates(array)
        if not models:
            raise InputError("a mixture needs two points that differ")
        model = models[self._best(array, models)]
        kinds = (np.asarray(value, dtype=np.float64) for value in (model.weights_, model.means_, model.covariances_))
        return Mixture(*kinds, labels=np.asarray(model.predict(array), dtype=np.int64))

    def candidates(self, points: NDArray[np.float64]) -> "list[GaussianMixture]":
        """Return a fit to `points` (n, 2) for each number of objects from 1 on; none where points do not differ."""
        most = min(self.most, len(np.unique(points, axis=0)))
        return [] if most <= 1 else [self._fit(points, k) for k in range(1, most + 1)]

    def chosen(self, points: NDArray[np.float64], models: "list[GaussianMixture]") -> Labels:
        """Return the labels (n,) of that of `models` which `choice` takes."""
        return np.asarray(models[self._best(points, models)].predict(points), dtype=np.int64)

    def _best(self, points: NDArray[np.float64], models: "list[GaussianMixture]") -> int:
        if self.choice == "elbow":
            return elbow(np.array([-model.score(points) for model in models]))
        return int(np.argmin([model.bic(points) for model in models]))

    def _fit(self, points: NDArray[np.float64], k: int) -> "GaussianMixture":
        from sklearn.mixture import GaussianMixture

        return GaussianMixture(k, reg_covar=self.floor, random_state=self.seed).fit(points)


def elbow(costs: NDArray[np.float64]) -> int:
    """Return the index of the elbow of falling `costs` (k,): the one furthest below the line from first to last."""
    line = np.linspace(costs[0], costs[-1], len(costs))
    return int(np.argmax(line - costs))


METHODS: dict[str, type[Heuristic] | type[KMeansObjects] | type[GaussianMixtureObjects] | type[Dbscan]] = {
    "heuristic": Heuristic,
    "kmeans": KMeansObjects,
    "gmm": GaussianMixtureObjects,
    "dbscan": Dbscan,
}


def make_clusterer(name: str, **settings: float | int | str) -> Clusterer:
    """Return the method `name` ("heuristic", "kmeans", "gmm" or "dbscan") with these settings.

    Raises:
        InputError: If the name or a setting is unknown, or a value is out of its range.
    """
    if name not in METHODS:
        raise unknown_name("clustering method", name, tuple(METHODS))
    try:
        return METHODS[name](**settings)  # pyright: ignore[reportArgumentType]
    except TypeError as error:
        raise InputError(f"clustering method {name!r}: {error}") from error


def clusterer_of_scans(name: str, distance: float, points: int) -> Clusterer:
    """Return the method `name` as localization and SLAM use it.

    Args:
        name: "heuristic", "kmeans", "gmm" or "dbscan".
        distance: Largest distance within an object [m]; K-Means and the Gaussian mixture have no use for it.
        points: Fewest points of an object; likewise.

    Raises:
        InputError: If the name is unknown, or a value is out of its range.
    """
    settings: dict[str, dict[str, float | int]] = {
        "heuristic": {"distance": distance, "min_points": points},
        "dbscan": {"epsilon": distance, "min_points": points},
    }
    return make_clusterer(name, **settings.get(name, {}))


def _best_silhouette(points: NDArray[np.float64], labels: list[NDArray[np.int32]]) -> int:
    from sklearn.metrics import silhouette_score

    scores = [silhouette_score(points, those) if 2 <= len(np.unique(those)) < len(points) else -1.0 for those in labels]
    return int(np.argmax(scores))


def _points(points: ArrayLike) -> NDArray[np.float64]:
    array = np.ascontiguousarray(points, dtype=np.float64)
    if array.size == 0:
        return np.zeros((0, 2))
    if array.ndim != 2 or array.shape[1] != 2 or not np.isfinite(array).all():
        raise InputError(f"`points` must be finite and have shape (n, 2), got shape {array.shape}")
    return array


def _check(distance: float, min_points: int) -> None:
    if not distance > 0.0:
        raise InputError(f"the distance of a cluster's points must be positive [m], got {distance}")
    if min_points < 1:
        raise InputError(f"`min_points` must be at least 1, got {min_points}")


def _check_choice(most: int, choice: str, known: tuple[str, ...]) -> None:
    if most < 1:
        raise InputError(f"`most` must be at least 1, got {most}")
    if choice not in known:
        raise unknown_name("choice of the number of objects", choice, known)
