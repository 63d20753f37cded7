"""A pose graph: poses of the plane and measurements between pairs of them."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..bounds import check_poses
from ..errors import InputError
from ..geometry import between

Array = NDArray[np.float64]

_MOST_INFORMATION = 1e18  # a standard deviation of a nanometre


@dataclass(frozen=True, eq=False)
class PoseGraph:
    """Poses x_i and measurements z_k of T_i_j with information Omega_k (the letters of Grisetti et al. 2010).

    Attributes:
        poses: (n, 3) T_w_i [m, m, rad].
        edges: (m, 2) the poses i and j of each measurement.
        measurements: (m, 3) measured T_i_j [m, m, rad].
        information: (m, 3, 3) inverse covariance of each measurement.
        kernel_width: (m,) Mahalanobis distance from which on a Cauchy kernel weakens a measurement; inf: never.

    Raises:
        InputError: If shapes do not fit, an edge leads nowhere or to itself, or something is not finite.
    """

    poses: Array
    edges: NDArray[np.int64]
    measurements: Array
    information: Array
    kernel_width: Array

    def __post_init__(self) -> None:
        n, m = len(self.poses), len(self.edges)
        wanted = {"poses": (n, 3), "edges": (m, 2), "measurements": (m, 3), "information": (m, 3, 3)}
        wanted["kernel_width"] = (m,)
        for name, shape in wanted.items():
            if getattr(self, name).shape != shape:
                raise InputError(f"`{name}` must have shape {shape}, got {getattr(self, name).shape}")
        if m and not (self.edges.min() >= 0 and self.edges.max() < n and (self.edges[:, 0] != self.edges[:, 1]).all()):
            raise InputError(f"`edges` must tie two different ones of the {n} poses")
        check_poses(self.poses, "poses", jumps=False)
        check_poses(self.measurements, "measurements", jumps=False)
        if not (np.abs(self.information) <= _MOST_INFORMATION).all():
            raise InputError(f"`information` must be finite and within {_MOST_INFORMATION:g}")

    @classmethod
    def of(cls, poses: Array, edges: NDArray[np.int64], measurements: Array, information: Array) -> "PoseGraph":
        """Return the graph without robust kernels."""
        return cls(poses, edges, measurements, information, np.full(len(edges), np.inf))

    def with_poses(self, poses: Array) -> "PoseGraph":
        """Return the same measurements at other poses (n, 3)."""
        return replace(self, poses=poses)

    def with_edges(self, wanted: NDArray[np.bool_]) -> "PoseGraph":
        """Return the graph with those of its measurements that are `wanted` (m,)."""
        return PoseGraph(
            self.poses,
            self.edges[wanted],
            self.measurements[wanted],
            self.information[wanted],
            self.kernel_width[wanted],
        )

    def errors(self) -> Array:
        """Return (m, 3) the errors z^-1 x_i^-1 x_j: pose j as the poses say, seen from where it was measured."""
        i, j = self.edges.T
        return between(self.measurements, between(self.poses[i], self.poses[j]))

    def squared_distances(self, errors: Array | None = None) -> Array:
        """Return (m,) the squared Mahalanobis distance of each error, kernels left out; `errors` (m, 3) if known."""
        errors = self.errors() if errors is None else errors
        return np.einsum("ka,kab,kb->k", errors, self.information, errors)

    def chi2(self) -> float:
        """Return the sum of squared Mahalanobis distances, kernels left out."""
        return float(self.squared_distances().sum())
