"""Registration of two maps: coarse by principal axes (PCA), fine by iterated closest points (ICP), Ye et al. 2021.

The principal axes leave the sign of the axes open, and a near-square room leaves the axes themselves open. So several
turns are tried, each is refined a little, and the one goes on where most of both maps lies on the other one. Principal
axes say nothing of where a part of a building lies in the whole: unless one map lies on the other, all places are
searched. Nothing is ever mirrored.
"""

from dataclasses import dataclass, field
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from ..bounds import Rounds, Within, check_numbers, check_points, check_positive
from ..errors import InputError
from ..geometry import compose, inverse, transform_points
from .icp import Cloud, SurfaceIcpConfig, icp_points, icp_surface
from .placements import placements

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class RegistrationConfig:
    """How two sets of points are registered."""

    coarse_points: Annotated[int, Within(1, 100_000)] = 1200
    """Points of each map that take part in the choice of the turn."""
    coarse_iterations: Rounds = 25
    """Iterations that each turn is refined, point to point, before the turns are compared."""
    isotropy: float = 0.5
    """Ratio of the smaller to the larger variance above which the axes say little: turns of 15 degrees, not of 90."""
    near_m: float = 0.2
    """A point that is so far from the other map counts as half on it [m]."""
    explained: float = 0.95
    """Unless so much of one map lies on the other, all places are searched; changes the time, hardly ever a result."""
    fine: SurfaceIcpConfig = field(default_factory=SurfaceIcpConfig)
    """The final refinement."""

    def __post_init__(self) -> None:
        check_numbers(self)
        check_positive(self, "coarse_points", "coarse_iterations", "near_m")
        for name in ("isotropy", "explained"):
            if not 0.0 <= getattr(self, name) <= 1.0:
                raise InputError(f"`{name}` must lie in [0, 1], got {getattr(self, name)}")


@dataclass(frozen=True, eq=False)
class Registration:
    """How an estimated map lies on a reference map.

    Attributes:
        T_ref_est: (3,) maps points of the estimate into the frame of the reference [m, m, rad].
        residual_m: Mean distance to the nearest point, mean of both directions [m].
        coarse_residual_m: The same for the best turn before the fine registration [m], on fewer points.
        iterations: Iterations of the fine registration.
        converged: Whether it came to rest within its `iterations`.
    """

    T_ref_est: Array
    residual_m: float
    coarse_residual_m: float
    iterations: int
    converged: bool


def register(estimate: Array, reference: Array, config: RegistrationConfig | None = None) -> Registration:
    """Register the points of an estimated map (M, 2) to those of a reference map (N, 2), both in metres.

    Raises:
        InputError: If a map has fewer than three points or a shape is not (n, 2).
    """
    config = config or RegistrationConfig()
    for name, points in (("estimate", estimate), ("reference", reference)):
        if points.ndim != 2 or points.shape[1] != 2 or len(points) < 3:
            raise InputError(f"registration needs at least 3 occupied cells in the {name}, got shape {points.shape}")
        check_points(points, name)
    est, ref = Cloud(estimate), Cloud(reference)
    coarse = _Coarse(est, ref, config)
    coarse.try_from(_starts(est, ref, config.isotropy))
    if coarse.explained < config.explained:
        coarse.try_from(placements(est, ref))
    fine = icp_surface(est, ref, coarse.T_ref_est, config.fine)
    return Registration(
        T_ref_est=fine.T_ref_est,
        residual_m=_residual(est, ref, fine.T_ref_est, est.points, ref.points),
        coarse_residual_m=_residual(est, ref, coarse.T_ref_est, coarse.part_est, coarse.part_ref),
        iterations=fine.iterations,
        converged=fine.converged,
    )


class _Coarse:
    """The best of some starts, each refined point to point on fewer points.

    Attributes:
        T_ref_est: (3,) where most of both maps lies on the other one.
        explained: How much of one of them lies on the other there, at least, 0 .. 1.
    """

    def __init__(self, est: Cloud, ref: Cloud, config: RegistrationConfig) -> None:
        self._est, self._ref, self._config = est, ref, config
        self.part_est, self.part_ref = est.sample(config.coarse_points), ref.sample(config.coarse_points)
        self.T_ref_est, self.explained = np.zeros(3), 0.0
        self._agreement = -1.0

    def try_from(self, starts: list[Array]) -> None:
        """Refine each of `starts` (3,), and keep the best of all so far."""
        config = self._config
        for start in starts:
            T_ref_est = icp_points(
                self._est, self._ref, self.part_ref, start, config.coarse_iterations, config.fine.outlier_m
            )
            shares = [
                float(np.mean(1.0 / (1.0 + (distances / config.near_m) ** 2)))
                for distances in _distances(self._est, self._ref, T_ref_est, self.part_est, self.part_ref)
            ]
            if sum(shares) > self._agreement:
                self.T_ref_est, self.explained, self._agreement = T_ref_est, max(shares), sum(shares)


def _starts(est: Cloud, ref: Cloud, isotropy: float) -> list[Array]:
    """Return the candidates for T_ref_est: principal axes on each other in every turn, and the frames as they are."""
    centre_est, angle_est, ratio_est = _principal_axis(est.points)
    centre_ref, angle_ref, ratio_ref = _principal_axis(ref.points)
    turns = 24 if max(ratio_est, ratio_ref) > isotropy else 4
    starts = [np.zeros(3)]
    for turn in np.arange(turns) * (2.0 * np.pi / turns):
        T_ref_axes = np.array((*centre_ref, angle_ref + turn))
        starts.append(compose(T_ref_axes, inverse((*centre_est, angle_est))))
    return starts


def _principal_axis(points: Array) -> tuple[Array, float, float]:
    """Return the centroid (2,), the direction of the first eigenvector [rad], and the ratio of the variances <= 1."""
    centre = points.mean(axis=0)
    values, vectors = np.linalg.eigh(np.cov(points - centre, rowvar=False))
    return centre, float(np.arctan2(vectors[1, 1], vectors[0, 1])), float(values[0] / max(values[1], 1e-12))


def _residual(est: Cloud, ref: Cloud, T_ref_est: Array, est_points: Array, ref_points: Array) -> float:
    to_est, to_ref = _distances(est, ref, T_ref_est, est_points, ref_points)
    return float((np.mean(to_est) + np.mean(to_ref)) / 2.0)


def _distances(est: Cloud, ref: Cloud, T_ref_est: Array, est_points: Array, ref_points: Array) -> tuple[Array, Array]:
    """Return how far `ref_points` are from the estimate, and `est_points` from the reference [m]."""
    to_est, _ = est.nearest.query(transform_points(inverse(T_ref_est), ref_points))
    to_ref, _ = ref.nearest.query(transform_points(T_ref_est, est_points))
    return to_est, to_ref
