"""One scan on one particle's map: where it lies best around a guess, and what the map says against it there."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..geometry import wrap_angle
from .config import TrackingConfig
from .fit_kernels import compare, search_samples, search_window
from .match_kernels import match
from .matcher import ParticleScanMatcher
from .tile_kernels import SIDE
from .tile_maps import TileMaps

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Candidate:
    """A pose that a scan may have been taken from.

    Attributes:
        pose: (3,) T_map_robot [m, m, rad].
        covariance: (3, 3) of it, by the scan and by what was known before.
        value: Log-likelihood, up to a constant: 0 is a scan that nothing speaks against, at the expected pose.
        against: Share of the points that lie where the map has seen free space.
        unknown: Share of the points that lie where it has seen nothing.
    """

    pose: Array
    covariance: Array
    value: float
    against: float
    unknown: float


class MapAlignment:
    """A scan to be laid on a particle's map.

    Args:
        maps: The maps.
        particle: Whose map it is.
        points_robot: (n, 2) returns in the robot frame [m], n > 0.
        matcher: Refines poses.
        config: Parameters.
    """

    def __init__(
        self, maps: TileMaps, particle: int, points_robot: Array, matcher: ParticleScanMatcher, config: TrackingConfig
    ) -> None:
        self._maps, self._matcher, self._config = maps, matcher, config
        self._directory = maps.directory[particle]
        self._scale = np.array([1.0 / maps.cell, 1.0 / maps.cell, 1.0])
        self._corner = np.array([maps.origin[0] * SIDE, maps.origin[1] * SIDE, 0.0])
        self._points = np.ascontiguousarray(matcher.thinned(points_robot, maps.cell) / maps.cell)
        few = max(1, len(self._points) // matcher.config.sample_points)
        self._few = np.ascontiguousarray(self._points[::few])

    def refined(self, start: Array, expected: Array, covariance: Array) -> Candidate:
        """Return where Gauss-Newton steps lead from `start` (3,), with a Gaussian around `expected` (3,) as a prior."""
        maps, matcher = self._maps, self._matcher
        pose, prior = self._to_cells(start), self._to_cells(expected)
        information = np.linalg.inv(covariance * self._scale[:, None] * self._scale)
        system = np.zeros((3, 4))
        match(
            pose,
            prior,
            information,
            self._points,
            matcher.stages,
            matcher.config.independent_points,
            matcher.config.sigma / maps.cell,
            matcher.config.straightness,
            self._directory,
            maps.counts,
            maps.means,
            maps.bits,
            system,
        )
        off = pose - prior
        return self._judged(pose, np.linalg.inv(system[:, :3]), 0.5 * float(off @ information @ off))

    def sampled(self, expected: Array, covariance: Array, samples: Array) -> Candidate:
        """Return the refined best of `samples` (m, 3) standard normal draws of a Gaussian around `expected` (3,)."""
        maps = self._maps
        root = np.linalg.cholesky(covariance * self._scale[:, None] * self._scale)
        pose = self._to_cells(expected)
        search_samples(
            pose.copy(), root, samples, self._few, self._config.weight, self._config.unseen, self._directory,
            maps.counts, maps.bits, pose,
        )  # fmt: skip
        return self.refined(self._to_metres(pose), expected, covariance)

    def around(self, centre: Array, reach: Array, enough: float) -> Candidate | None:
        """Return the refined best pose within `reach` (2,) [m, rad] of `centre` (3,); None: none is worth `enough`."""
        maps, config = self._maps, self._config
        step = np.array([config.window_step, config.window_step, config.window_turn])
        steps = np.ceil(np.array([reach[0], reach[0], min(reach[1], np.pi)]) / step).astype(np.int64)
        pose = self._to_cells(centre)
        value = search_window(
            pose.copy(), steps, step * self._scale, self._few, config.weight, config.unseen, enough, self._directory,
            maps.counts, maps.bits, pose,
        )  # fmt: skip
        if value == -np.inf:
            return None
        deviations = 0.5 * np.array([reach[0], reach[0], reach[1]])
        return self.refined(self._to_metres(pose), centre, np.diag(deviations**2))

    def _judged(self, pose: Array, covariance: Array, distance: float) -> Candidate:
        maps, config, n = self._maps, self._config, max(len(self._points), 1)
        x, y, theta = pose
        against, unknown = compare(
            x, y, theta, self._points, config.unseen, np.inf, self._directory, maps.counts, maps.bits
        )
        value = -config.weight * against / n - distance
        spoken = (against - config.unseen * unknown) / n
        return Candidate(
            self._to_metres(pose), covariance / self._scale[:, None] / self._scale, value, spoken, unknown / n
        )

    def _to_cells(self, pose: Array) -> Array:
        return pose * self._scale - self._corner

    def _to_metres(self, pose: Array) -> Array:
        pose = (pose + self._corner) / self._scale
        pose[2] = wrap_angle(pose[2])
        return pose
