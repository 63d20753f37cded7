"""Aligns a scan with every particle's map: the mode of the improved proposal and its covariance."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..processes.threads import Workers
from .config import MatcherConfig
from .match_kernels import match_particles
from .search_kernels import search_particles
from .thinning_kernel import first_of_squares
from .tile_kernels import SIDE
from .tile_maps import TileMaps

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Matches:
    """The Gaussian of each particle's pose given its map, the scan and the odometry.

    Attributes:
        modes: (P, 3) most likely poses T_map_robot [m, m, rad].
        roots: (P, 3, 3) lower Cholesky factors of their covariances.
        losses: (P,) mean robust loss of the points at the mode, 0 (all on the map) to 1 (none).
    """

    modes: Array
    roots: Array
    losses: Array


class ParticleScanMatcher:
    """Looks for a start among samples of the odometry's error, then takes Gauss-Newton steps from coarse to fine.

    Args:
        config: Parameters.
        workers: Threads to match with.
    """

    def __init__(self, config: MatcherConfig, workers: Workers) -> None:
        self.config = config
        self._workers = workers
        self.stages = np.array([config.windows, config.strides, config.iterations, config.scales], dtype=np.float64).T

    def match(
        self, maps: TileMaps, points_robot: Array, means: Array, covariances: Array, rng: np.random.Generator
    ) -> Matches:
        """Align one scan with all maps.

        Args:
            maps: The maps.
            points_robot: (n, 2) returns in the robot frame [m].
            means: (P, 3) poses by odometry, T_map_robot.
            covariances: (P, 3, 3) of the odometry, map frame.
            rng: Source of the samples.
        """
        scale = np.array([1.0 / maps.cell, 1.0 / maps.cell, 1.0])
        corner = np.append(maps.origin * SIDE, 0)
        covariances = covariances * scale[:, None] * scale
        points = np.ascontiguousarray(self.thinned(points_robot, maps.cell) / maps.cell)
        priors = means * scale - corner
        poses = self._search(maps, points, priors, covariances, rng)
        systems, losses = self._refine(maps, points, priors, covariances, poses)
        roots = np.linalg.cholesky(np.linalg.inv(systems[:, :, :3])) / scale[:, None]
        return Matches((poses + corner) / scale, roots, losses)

    def thinned(self, points: Array, cell: float) -> Array:
        """Return the first of `points` (n, 2) [m] in each square, in their order."""
        return first_of_squares(points, cell * self.config.thinning)

    def _search(
        self, maps: TileMaps, points: Array, priors: Array, covariances: Array, rng: np.random.Generator
    ) -> Array:
        samples = rng.standard_normal((self.config.samples, 3))
        samples[0] = 0.0
        few = points[:: max(1, len(points) // self.config.sample_points)]
        roots = np.linalg.cholesky(covariances)
        poses = priors.copy()
        weight, directory, near = self.config.sample_weight, maps.directory, maps.near
        self._workers.run(
            lambda start, stop: search_particles(
                start, stop, priors, roots, samples, few, weight, directory, near, poses
            ),
            len(priors),
        )
        return poses

    def _refine(
        self, maps: TileMaps, points: Array, priors: Array, covariances: Array, poses: Array
    ) -> tuple[Array, Array]:
        """Move `poses` to their modes; return (P, 3, 4) systems, whose first three columns are information, losses."""
        config, information = self.config, np.linalg.inv(covariances)
        systems, losses = np.zeros((len(poses), 3, 4)), np.ones(len(poses))
        self._workers.run(
            lambda start, stop: match_particles(
                start,
                stop,
                poses,
                priors,
                information,
                points,
                self.stages,
                config.independent_points,
                config.sigma / maps.cell,
                config.straightness,
                maps.directory,
                maps.counts,
                maps.means,
                maps.bits,
                systems,
                losses,
            ),
            len(poses),
        )
        return systems, losses
