"""One scan on one particle's map: where it lies best around a guess, and what the map says against it there."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..geometry import wrap_one
from ..search.branch_and_bound import SearchWindow, Separation, branch_and_bound
from ..search.score_pyramid import ScoreGrid, build_pyramid
from .align_kernels import log_likelihood
from .config import TrackingConfig
from .fit_kernels import draw_scores, search_samples
from .match_kernels import match
from .matcher import ParticleScanMatcher
from .tile_kernels import SIDE
from .tile_maps import TileMaps

Array = NDArray[np.float64]

_SEARCH_CELL = 0.1  # [m] of the search without odometry; the refinement reaches twice as far
_TOP_LEVEL = 3
_FAR = 40.0  # [m] farther points do not take part in it: the part of the map that is searched stays below 1 MB
_NEAR_WORTH = np.uint8(204)  # beside an occupied place; less than on it, so that maxima stand in the middle
_UNKNOWN_WORTH = np.uint8(128)  # between occupied and free; maxima are to lie where the map knows something
_MOST_UNKNOWN = 0.5  # share of the points
_ROUGH = 4.0  # a pose of the coarse search may be worth so much less than what it is refined to
_INDEPENDENT = 0.5  # share of the points that tell of a lie independently of each other: see docs/methods/gmapping.md
_MAXIMA, _SEPARATION = 3, Separation(linear=0.4, angular=0.2)


@dataclass(frozen=True, eq=False)
class Candidate:
    """A pose that a scan may have been taken from.

    Attributes:
        pose: (3,) T_map_robot [m, m, rad].
        covariance: (3, 3) of it, by the scan and by what was known before.
        value: Log-likelihood, up to a constant: 0 is a scan that nothing speaks against, at the expected pose.
        against: Share of the points that lie where the map has seen free space.
        unknown: Share of the points that lie where it has seen nothing.
        loss: Mean robust loss of the points after the last step, 0 .. 1; 1 of a pose that no step has led to.
        explained: As `value`, with points that count in proportion to their number.
        occam: Log of the Occam factor: the share of the poses thought possible beforehand that the scan leaves, by the
            determinants of the covariances.
    """

    pose: Array
    covariance: Array
    value: float
    against: float
    unknown: float
    loss: float = 1.0
    explained: float = 0.0
    occam: float = 0.0

    @property
    def evidence(self) -> float:
        """Log-likelihood of the scan whatever the pose, by Laplace's approximation (MacKay 1992): where many poses are
        possible, one of them will fit by chance, the sooner the less the scan sees."""
        return self.explained + self.occam


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
        self._worth = min(matcher.config.weight, float(len(self._points)))

    def refined(self, start: Array, expected: Array, covariance: Array, *, near: bool = False) -> Candidate:
        """Return where Gauss-Newton steps lead from `start` (3,), with a Gaussian around `expected` (3,) as a prior.

        From a start that is `near` only the last, finest stage is needed.
        """
        maps, matcher = self._maps, self._matcher
        pose, prior, information = self._in_cells(start, expected, covariance)
        system = np.zeros((3, 4))
        _, loss = match(
            pose,
            prior,
            information,
            self._points,
            matcher.stages[-1:] if near else matcher.stages,
            matcher.config.independent_points,
            matcher.config.sigma / maps.cell,
            matcher.config.straightness,
            self._directory,
            maps.counts,
            maps.means,
            maps.bits,
            system,
        )
        return self._judged(pose, prior, information, np.linalg.inv(system[:, :3]), loss)

    def sampled(self, expected: Array, covariance: Array, samples: Array) -> Candidate:
        """Return the refined best of `samples` (m, 3) standard normal draws of a Gaussian around `expected` (3,)."""
        maps, matcher = self._maps, self._matcher.config
        root = np.linalg.cholesky(covariance * self._scale[:, None] * self._scale)
        pose = self._to_cells(expected)
        search_samples(
            pose.copy(), root, samples, self._matcher.few(self._points), self._worth, matcher.unseen,
            self._directory, maps.counts, maps.near, pose,
        )  # fmt: skip
        return self.refined(self._to_metres(pose), expected, covariance)

    def around(self, centre: Array, reach: Array, enough: float, least: float) -> list[Candidate]:
        """Return the refined best poses within `reach` (2,) [m, rad] of `centre` (3,) whose evidence may be `enough`,
        and whose value `least`.

        The map knows most of what the scan sees there: a place where it knows nothing explains any scan.
        """
        config, points = self._config, self._matcher.few(self._points) * self._maps.cell
        points = points[np.hypot(*points.T) <= _FAR]
        if not len(points):
            return []
        window = SearchWindow(linear=float(reach[0]), angular=float(reach[1]), angular_step=config.window_turn)
        grid = self._scores(centre, float(reach[0]) + float(np.hypot(*points.T).max()))
        pyramid = build_pyramid(grid, top_level=_TOP_LEVEL, margin=window.reach(grid.resolution) + (1 << _TOP_LEVEL))
        missed = min(-enough / (_INDEPENDENT * len(self._points)), -least / self._worth) + _ROUGH / self._worth
        found = branch_and_bound(
            pyramid, points, centre, window, min_score=max(0.0, 1.0 - missed), maxima=_MAXIMA, separation=_SEPARATION
        )
        covariance = _covariance(reach)
        settled = (self._settled(np.array(each.pose), centre, covariance) for each in found.maxima)
        return [each for each in settled if each.unknown <= _MOST_UNKNOWN]

    def steady(self, centre: Array, expected: Array, reach: Array) -> Candidate:
        """Return where steps lead from the pose `expected` (3,) of a robot that goes on as before; see `around`."""
        near = self.refined(expected, expected, _covariance(0.25 * reach))
        return self._settled(near.pose, centre, _covariance(reach))

    def _settled(self, start: Array, expected: Array, covariance: Array) -> Candidate:
        """Return the better one of a pose of a search and what it is refined to."""
        step = np.array([_SEARCH_CELL, _SEARCH_CELL, self._config.window_turn]) * self._scale
        kept = self._judged(*self._in_cells(start, expected, covariance), np.diag(step**2))
        refined = self.refined(start, expected, covariance)
        return max(replace(kept, occam=min(kept.occam, refined.occam)), refined, key=_value)

    def _scores(self, centre: Array, radius: float) -> ScoreGrid:
        """Return what a point is worth at each place within `radius` [m] of `centre`."""
        maps = self._maps
        side = max(1, round(_SEARCH_CELL / maps.cell))
        x, y, _ = self._to_cells(centre)
        reach = int(np.ceil(radius / maps.cell / side)) + 2
        row, col = int(np.floor(y)) - reach * side, int(np.floor(x)) - reach * side
        values = np.empty((2 * reach, 2 * reach), dtype=np.uint8)
        draw_scores(row, col, side, _UNKNOWN_WORTH, _NEAR_WORTH, self._directory, maps.counts, maps.bits, values)
        corner = (np.array([col, row]) + self._corner[:2]) * maps.cell
        return ScoreGrid(values, (float(corner[0]), float(corner[1])), side * maps.cell)

    def _judged(
        self,
        pose: Array,
        prior: Array,
        information: NDArray[np.floating],
        covariance: NDArray[np.floating],
        loss: float = 1.0,
    ) -> Candidate:
        """Return a pose with what speaks for it; all in cells."""
        points, maps, config, n = self._points, self._maps, self._matcher.config, max(len(self._points), 1)
        value, against, unknown = log_likelihood(
            pose, prior, information, points, config.weight, config.unseen, self._directory, maps.counts, maps.near
        )
        spoken = (against - config.unseen * unknown) / n
        occam = 0.5 * float(np.linalg.slogdet(covariance)[1] + np.linalg.slogdet(information)[1])
        return Candidate(
            self._to_metres(pose),
            covariance / self._scale[:, None] / self._scale,
            value,
            spoken,
            unknown / n,
            loss,
            explained=value + (self._worth / n - _INDEPENDENT) * against,
            occam=occam,
        )

    def _in_cells(self, pose: Array, prior: Array, covariance: Array) -> tuple[Array, Array, NDArray[np.floating]]:
        """Return a pose and a prior (3,), their headings less than half a turn apart, and its information (3, 3)."""
        pose, prior = self._to_cells(pose), self._to_cells(prior)
        pose[2] = prior.item(2) + wrap_one(pose.item(2) - prior.item(2))
        return pose, prior, np.linalg.inv(covariance * self._scale[:, None] * self._scale)

    def _to_cells(self, pose: Array) -> Array:
        return pose * self._scale - self._corner

    def _to_metres(self, pose: Array) -> Array:
        pose = (pose + self._corner) / self._scale
        pose[2] = wrap_one(pose.item(2))
        return pose


def _covariance(reach: Array) -> Array:
    """Return the covariance (3, 3) of a pose whose two standard deviations are `reach` (2,) [m, rad]."""
    return np.diag(0.25 * np.array([reach[0], reach[0], reach[1]]) ** 2)


def _value(candidate: Candidate) -> float:
    return candidate.value
