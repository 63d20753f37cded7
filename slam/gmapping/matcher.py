"""Aligns a scan with every particle's map: the mode of the improved proposal and its covariance."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .config import MatcherConfig
from .match_kernels import match_particles
from .tile_kernels import SIDE
from .tile_maps import TileMaps
from .workers import Workers

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Matches:
    """The Gaussian of each particle's pose given its map, the scan and the odometry.

    Attributes:
        modes: (P, 3) most likely poses T_map_robot [m, m, rad].
        roots: (P, 3, 3) lower Cholesky factors of their covariances.
        losses: (P,) mean robust loss of the points at the mode, 0 (all on the map) to 1 (none).
        surprises: (P,) squared Mahalanobis distance of the mode from the odometry.
    """

    modes: Array
    roots: Array
    losses: Array
    surprises: Array


class ScanMatcher:
    """Gauss-Newton from coarse to fine, with the odometry as a prior.

    Args:
        config: Parameters.
        workers: Threads to match with.
    """

    def __init__(self, config: MatcherConfig, workers: Workers) -> None:
        self.config = config
        self._workers = workers
        self._stages = np.array([config.windows, config.strides, config.iterations, config.scales], dtype=np.float64).T

    def match(self, maps: TileMaps, points_robot: Array, starts: Array, means: Array, covariances: Array) -> Matches:
        """Align one scan with all maps.

        Args:
            maps: The maps.
            points_robot: (n, 2) returns in the robot frame [m].
            starts: (P, 3) poses to start from, T_map_robot.
            means: (P, 3) poses by odometry, T_map_robot.
            covariances: (P, 3, 3) of the odometry, map frame.
        """
        scale = np.array([1.0 / maps.cell, 1.0 / maps.cell, 1.0])
        corner = np.append(maps.origin * SIDE, 0)
        poses, priors = starts * scale - corner, means * scale - corner
        information = np.linalg.inv(covariances * scale[:, None] * scale)
        points = np.ascontiguousarray(self.thinned(points_robot, maps.cell) / maps.cell)
        systems, losses = np.zeros((len(poses), 3, 4)), np.ones(len(poses))
        config = self.config
        self._workers.run(
            lambda start, stop: match_particles(
                start,
                stop,
                poses,
                priors,
                information,
                points,
                self._stages,
                config.independent_points,
                config.sigma / maps.cell,
                config.straightness,
                maps.directory,
                maps.means,
                maps.bits,
                systems,
                losses,
            ),
            len(poses),
        )
        offsets = poses - priors
        roots = np.linalg.cholesky(np.linalg.inv(systems[:, :, :3])) / scale[:, None]
        surprises = np.einsum("pi,pij,pj->p", offsets, information, offsets)
        return Matches((poses + corner) / scale, roots, losses, surprises)

    def thinned(self, points: Array, cell: float) -> Array:
        """Return the first of `points` (n, 2) [m] in each square, in their order."""
        squares = np.floor(points / (cell * self.config.thinning)).astype(np.int64)
        keys = squares[:, 0] * 2**32 + squares[:, 1]
        return points[np.sort(np.unique(keys, return_index=True)[1])]
