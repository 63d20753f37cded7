"""Aligns a scan with every particle's map: the mode of the improved proposal and its covariance."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..processes.threads import Workers
from .align_kernels import align_particles
from .config import MatcherConfig
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
        points: How many of the scan's points took part, one in a square.
    """

    modes: Array
    roots: Array
    losses: Array
    points: int


class ParticleScanMatcher:
    """Takes Gauss-Newton steps from where each particle is expected.

    Where the map speaks against the pose that they lead to, it looks for a start among samples of the odometry's error,
    and takes steps from coarse to fine.

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
        samples = rng.standard_normal((self.config.samples, 3))
        samples[0] = 0.0
        poses, systems, losses = self._aligned(maps, points, priors, covariances, samples)
        roots = np.linalg.cholesky(np.linalg.inv(systems[:, :, :3])) / scale[:, None]
        return Matches((poses + corner) / scale, roots, losses, len(points))

    def thinned(self, points: Array, cell: float) -> Array:
        """Return the first of `points` (n, 2) [m] in each square, in their order."""
        return first_of_squares(points, cell * self.config.thinning)

    def few(self, points: Array) -> Array:
        """Return those of the thinned `points` (n, 2) that judge a sample."""
        return np.ascontiguousarray(points[:: max(1, len(points) // self.config.sample_points)])

    def _aligned(
        self, maps: TileMaps, points: Array, priors: Array, covariances: Array, samples: Array
    ) -> tuple[Array, Array, Array]:
        """Return the modes (P, 3), (P, 3, 4) systems, whose first three columns are information, and losses (P,)."""
        config, directory = self.config, maps.directory
        few = self.few(points)
        roots, informations = np.linalg.cholesky(covariances), np.linalg.inv(covariances)
        poses, systems, losses = priors.copy(), np.zeros((len(priors), 3, 4)), np.ones(len(priors))

        def align(start: int, stop: int) -> None:
            """Match the particles from `start` up to `stop`; threads share them."""
            align_particles(
                start, stop, priors, roots, informations, samples, few, points, self.stages,
                config.independent_points, config.sigma / maps.cell, config.straightness, config.weight, config.unseen,
                config.suspicion, directory, maps.counts, maps.means, maps.bits, maps.near, poses, systems, losses,
            )  # fmt: skip

        self._workers.run(align, len(priors))
        return poses, systems, losses
