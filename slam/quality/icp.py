"""Iterated closest points (ICP) between two clouds of the plane: point to point, and piece of wall to piece of wall.

The cells of two maps lie on lattices. Where the lattices are parallel, points that are paired with points snap from one
lattice place to the next and stop up to several cells away from where the walls agree; pieces of wall do not.
"""

from dataclasses import dataclass, fields
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from ..bounds import Rounds, Within, check_numbers
from ..errors import InputError
from ..geometry import compose, inverse, transform_points
from .map_kernels import describe_pieces
from .nearest import NearestPoints
from .rigid import fit_rigid

Array = NDArray[np.float64]

_BACK = 0.1  # [m] from a point to the nearest of the other map and back: farther, and the two are not of one wall
_LEAST_PAIRS = 3


@dataclass(frozen=True, kw_only=True)
class SurfaceIcpConfig:
    """How pieces of wall are laid on each other."""

    points: Annotated[int, Within(1, 1000)] = 20
    """Points that describe the piece of wall around a point, itself included."""
    reach_m: float = 0.2
    """How far from it they may be [m]."""
    outlier_m: float = 0.04
    """Pairs farther apart than this pull with constant force, as in a mean distance (Huber) [m]."""
    iterations: Rounds = 200
    """Most iterations."""
    tolerance_m: float = 2e-5
    """It has come to rest when no point moves farther than this in an iteration [m]."""

    def __post_init__(self) -> None:
        check_numbers(self)
        for field in fields(self):
            if not getattr(self, field.name) > 0:
                raise InputError(f"`{field.name}` must be positive, got {getattr(self, field.name)}")


@dataclass(frozen=True, eq=False)
class IcpResult:
    """How one cloud lies on another.

    Attributes:
        T_ref_est: (3,) maps points of the estimate into the frame of the reference [m, m, rad].
        iterations: How many iterations were made.
        converged: Whether the motion came to rest.
    """

    T_ref_est: Array
    iterations: int
    converged: bool


class Cloud:
    """Points (n, 2) [m] with their search tree."""

    def __init__(self, points: Array) -> None:
        self.points = points
        self.nearest = NearestPoints(points)

    def sample(self, count: int) -> Array:
        """Return at most `count` points, drawn at even steps through the order of the points."""
        return self.points[np.linspace(0, len(self.points) - 1, min(count, len(self.points))).astype(int)]


@dataclass(frozen=True, eq=False)
class Pairs:
    """Points of the reference with the estimated ones nearest to them, where the way back ends where it began.

    Attributes:
        reference: (n,) which points of the reference, of those that take part.
        estimate: (n,) which estimated ones.
        distances: (n,) between the two [m].
    """

    reference: NDArray[np.intp]
    estimate: NDArray[np.intp]
    distances: Array


def icp_points(est: Cloud, ref: Cloud, part_ref: Array, T_ref_est: Array, iterations: int, outlier_m: float) -> Array:
    """Return `T_ref_est` (3,) refined by pairs of points, of those of the reference that are in `part_ref` (n, 2).

    Huber weights make pairs farther apart than `outlier_m` count by distance instead of its square, as in ADNN.
    """
    for _ in range(iterations):
        pairs = _paired(est, ref, part_ref, T_ref_est)
        if len(pairs.reference) < _LEAST_PAIRS:
            break
        weights = _huber(pairs.distances, outlier_m)
        T_ref_est = fit_rigid(est.points[pairs.estimate], part_ref[pairs.reference], weights)
    return T_ref_est


def icp_surface(est: Cloud, ref: Cloud, T_ref_est: Array, config: SurfaceIcpConfig) -> IcpResult:
    """Refine `T_ref_est` (3,) by pieces of wall.

    Gauss-Newton on the same pairs as in `icp_points`, with the middles of the two pieces in place of the points; across
    the estimated piece their distance counts in full, along it the less the straighter the piece is.
    """
    ref_middles, _ = _pieces(ref, config)
    est_middles, metrics = _pieces(est, config)
    T_est_ref = inverse(T_ref_est)
    for done in range(1, config.iterations + 1):
        pairs = _paired(est, ref, ref.points, inverse(T_est_ref))
        if len(pairs.reference) < _LEAST_PAIRS:
            return IcpResult(inverse(T_est_ref), done, False)
        moved = transform_points(T_est_ref, ref_middles[pairs.reference])
        weights = _huber(pairs.distances, config.outlier_m)
        step = _newton_step(moved, est_middles[pairs.estimate], metrics[pairs.estimate], weights)
        T_est_ref = compose(step, T_est_ref)
        if np.abs(transform_points(step, moved) - moved).max() < config.tolerance_m:
            return IcpResult(inverse(T_est_ref), done, True)
    return IcpResult(inverse(T_est_ref), config.iterations, False)


def _paired(est: Cloud, ref: Cloud, part_ref: Array, T_ref_est: Array) -> Pairs:
    """Return the pairs of nearest points that lead back to where they came from, for `part_ref` (n, 2).

    A wall that only one of the maps has is nearest to the end of another one, which is nearest to something else: it
    would pull the maps apart, the farther the less has been mapped.
    """
    distances, nearest = est.nearest.query(transform_points(inverse(T_ref_est), part_ref))
    _, back = ref.nearest.query(transform_points(T_ref_est, est.points[nearest]))
    mutual = np.flatnonzero(np.linalg.norm(ref.points[back] - part_ref, axis=1) <= _BACK)
    return Pairs(mutual, nearest[mutual], distances[mutual])


def _pieces(cloud: Cloud, config: SurfaceIcpConfig) -> tuple[Array, Array]:
    """Return, for the piece of wall around each point, its middle (n, 2) and the metric (n, 2, 2) of distances to it.

    With the variances v >= u of the piece along and across, the metric is 1 across and (u / v)^2 along.
    """
    count = min(config.points, len(cloud.points))
    _, neighbours = cloud.nearest.tree.query(cloud.points, k=count, distance_upper_bound=config.reach_m)
    middles, spreads = np.empty((len(cloud.points), 2)), np.empty((len(cloud.points), 2, 2))
    describe_pieces(cloud.points, np.reshape(neighbours, (len(cloud.points), count)), middles, spreads)
    variances, axes = np.linalg.eigh(spreads)
    lone = variances[:, 1] < 1e-12  # a point without neighbours counts alike in all directions
    along = np.where(lone, 1.0, (variances[:, 0] / np.where(lone, 1.0, variances[:, 1])) ** 2)
    scales = np.stack((np.ones_like(along), along), axis=-1)
    return middles, np.einsum("nik,nk,njk->nij", axes, scales, axes)


def _newton_step(moved: Array, target: Array, metrics: Array, weights: Array) -> Array:
    """Return the small motion (3,) that best carries `moved` (n, 2) onto `target` (n, 2) under `metrics` (n, 2, 2)."""
    centre = moved.mean(axis=0)
    jacobian = np.zeros((len(moved), 2, 3))
    jacobian[:, 0, 0] = jacobian[:, 1, 1] = 1.0
    jacobian[:, :, 2] = (moved - centre)[:, ::-1] * (-1.0, 1.0)
    weighted = np.einsum("n,nij,njk->nik", weights, metrics, jacobian)
    information = np.einsum("nia,nib->ab", jacobian, weighted)
    gradient = np.einsum("nia,ni->a", weighted, target - moved)
    # a straight wall alone leaves the motion along itself open: then stay
    x, y, theta = np.linalg.lstsq(information, gradient, rcond=1e-9)[0]
    return compose((centre[0] + x, centre[1] + y, theta), (-centre[0], -centre[1], 0.0))


def _huber(distances: Array, outlier: float) -> Array:
    return np.minimum(1.0, outlier / np.maximum(distances, 1e-9))
