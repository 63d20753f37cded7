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
from ..geometry import compose, transform_points
from .map_kernels import describe_pieces
from .nearest import NearestPoints
from .rigid import fit_rigid

Array = NDArray[np.float64]

_SQUARE = 0.5  # [m]


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
        T_whole_part: (3,) maps points of the smaller map into the frame of the larger one [m, m, rad].
        iterations: How many iterations were made.
        converged: Whether the motion came to rest.
    """

    T_whole_part: Array
    iterations: int
    converged: bool


class Cloud:
    """Points (n, 2) [m] with their search tree."""

    def __init__(self, points: Array) -> None:
        self.points = points
        self.nearest = NearestPoints(points)

    @property
    def extent(self) -> float:
        """The longer side of the rectangle around the points [m]."""
        return float(np.ptp(self.points, axis=0).max())

    @property
    def size(self) -> int:
        """How many squares of half a metre hold points: how much is mapped, whatever the cells; strays hardly count."""
        return len(np.unique(np.floor(self.points / _SQUARE), axis=0))

    def sample(self, count: int) -> Array:
        """Return at most `count` points, drawn at even steps through the order of the points."""
        return self.points[np.linspace(0, len(self.points) - 1, min(count, len(self.points))).astype(int)]


def icp_points(whole: Cloud, points: Array, T_whole_part: Array, iterations: int, outlier_m: float) -> Array:
    """Return `T_whole_part` (3,) refined by pairs: each of `points` (n, 2) of the smaller map with the nearest one.

    So a wall that only the larger map has attracts nothing. Huber weights make pairs farther apart than `outlier_m`
    count by distance instead of its square, as in ADNN: a wall that only the smaller map has pulls little.
    """
    for _ in range(iterations):
        distances, nearest = whole.nearest.query(transform_points(T_whole_part, points))
        T_whole_part = fit_rigid(points, whole.points[nearest], _huber(distances, outlier_m))
    return T_whole_part


def icp_surface(part: Cloud, whole: Cloud, T_whole_part: Array, config: SurfaceIcpConfig) -> IcpResult:
    """Refine `T_whole_part` (3,) by pieces of wall.

    Gauss-Newton on the same pairs as in `icp_points`, with the middles of the two pieces in place of the points; across
    the piece of the larger map their distance counts in full, along it the less the straighter the piece is.
    """
    part_middles, _ = _pieces(part, config)
    whole_middles, metrics = _pieces(whole, config)
    for done in range(1, config.iterations + 1):
        distances, nearest = whole.nearest.query(transform_points(T_whole_part, part.points))
        moved = transform_points(T_whole_part, part_middles)
        step = _newton_step(moved, whole_middles[nearest], metrics[nearest], _huber(distances, config.outlier_m))
        T_whole_part = compose(step, T_whole_part)
        if np.abs(transform_points(step, moved) - moved).max() < config.tolerance_m:
            return IcpResult(T_whole_part, done, True)
    return IcpResult(T_whole_part, config.iterations, False)


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
