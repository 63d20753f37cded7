"""Scan-to-submap matching: correlative search where odometry leaves much open, then non-linear least squares."""

import math
from dataclasses import dataclass, replace
from typing import Annotated, Protocol

import numpy as np
from numpy.typing import NDArray

from ..bounds import FINEST_STEP, Angle, Cell, Rounds, Within, check_numbers
from ..errors import InputError
from ..geometry import transform_points, wrap_one
from ..view_kernel import kernel
from .correlative import correlate
from .extrapolator import Prediction
from .refine_kernels import refine_pose
from .voxel_filter import voxel_first
from .wide_search import search_widely

Array = NDArray[np.float64]

DOUBT = 3.0
"""A place that is less likely than the best by so much, one to twenty, is not in question [nats]."""

_SCORE_MEMORY = 0.1  # share of the newest score in the typical one
_TYPICAL_SCORE = 0.5  # before any match: of ten logs, most scores are between 0.45 and 0.65
_FITS = 0.5  # of the typical score before any match: what fits worse shows something else than the map
_TRUSTED = 100.0  # times more than elsewhere the odometry counts along a degenerate direction
_MOST_POSES = 50_000_000  # of a correlative search, of each of its points: seconds; by default it has 10^5
_COMPARED = 0.25  # share of its weight that a scan has where it is weighed against other evidence: its points err alike
_FIRM = 1.5  # times as firmly as by its curvature a scan is tied to the submap that it is drawn into
_UNKNOWN = 0.5  # of a usual score: a point where nothing is known fits as likely as not
_SLIP = np.array([0.05, 0.1])  # [m, rad] what a wheel may slip at no motion


@dataclass(frozen=True, kw_only=True)
class GridScanMatcherConfig:
    """Settings of `GridScanMatcher`.

    Attributes:
        weight: Weight of a point's `1 - occupancy` beside the odometry's squared error over its variance.
        apart: Points in one square of this side count as one, since they err alike: else a thousand beams on one wall
            outvote any odometry, and thirty beams that look all around do not correct it [m] ...
        independent: ... and at most so many points of a scan count.
        sigmas: The search window reaches so many standard deviations of the odometry.
        max_linear: But not farther than this [m].
        max_angular: And not turned further than this [rad].
        capture: Errors of points below this [m] are left to the least squares: no search.
        search_points: The search uses about so many of the points.
        iterations: Most iterations of the least squares.
        min_points: Fewer points than this match nothing.
        retry_below: A score below so much of the typical one makes the matcher search more widely ...
        retry_found: ... and it takes what it finds where the score is at least so much of the typical one.
        retry_sigmas: How many times wider the odometry's errors count then.
        explained: A scan says that the robot is far from where it was expected only if its score there is at least so
            much of the typical one of what it sees of the submap there.
        beside: A scan sees nothing of what it was matched on if its score is below so much of the typical one, and only
            this share of it tells.
    """

    weight: float = 3.0
    apart: Cell = 0.1
    independent: int = 90
    sigmas: float = 3.0
    max_linear: Annotated[float, Within(0.0, 10.0)] = 0.5
    max_angular: Angle = 0.5
    capture: float = 0.06
    search_points: Annotated[int, Within(1, 10_000)] = 100
    iterations: Rounds = 20
    min_points: int = 10
    retry_below: float = 0.7
    retry_found: float = 0.75
    explained: float = 0.5
    beside: float = 0.25
    retry_sigmas: float = 10.0

    def __post_init__(self) -> None:
        check_numbers(self)
        for name, value in vars(self).items():
            if not value > 0:
                raise InputError(f"`{name}` must be positive, got {value}")


@dataclass(frozen=True, eq=False)
class GridMatch:
    """Where a scan fits on a submap.

    Attributes:
        pose: (3,) T_local_robot [m, m, rad].
        curvature: (3, 3) of its misfit there, local frame: inverse covariance without that of the prior.
        score: Mean occupancy under the points, in [0, 1].
        searched: Whether the correlative search was needed.
        retried: Whether it was found only far from where the odometry expects it.
        seen: Share of the points that the match is of: the others lie where nothing is known.
    """

    pose: Array
    curvature: Array
    score: float
    searched: bool
    retried: bool = False
    seen: float = 1.0

    @property
    def fits(self) -> bool:
        """Whether so much of what the scan sees fits that something can be learned from it.

        Where hardly anything does, it shows what is not of the map, as people who walk along with the robot and draw
        matches their way: by these, good odometry would seem rough, and be left to them.
        """
        return self.score >= _FITS * _TYPICAL_SCORE * self.seen

    @property
    def information(self) -> Array:
        """(3, 3) how firmly it is tied to the submap, inverse covariance."""
        return _FIRM * self.curvature

    @property
    def told(self) -> Array:
        """(3, 3) what the scan tells of the pose beside other evidence, inverse covariance."""
        return _COMPARED * self.information


class Walls(Protocol):
    """What a scan can be matched on: a submap, or a finished map."""

    @property
    def field(self) -> NDArray[np.float32]:
        """(rows, cols) occupancy of each cell in [0, 1]; 0 where nothing is known."""
        ...

    @property
    def corner(self) -> Array:
        """(2,) centre of cell [0, 0] [m]."""
        ...

    @property
    def resolution(self) -> float:
        """Side of a cell [m]."""
        ...


class GridScanMatcher:
    """Finds the pose of a scan in a submap's frame, near where odometry expects it.

    Where a scan fits much worse than scans usually do, the odometry may have slipped: it is searched for again with
    ten times the odometry's standard deviations, and what wheels slip at rest.

    Args:
        config: Settings.
    """

    def __init__(self, config: GridScanMatcherConfig) -> None:
        self._config = config
        self._typical_score = _TYPICAL_SCORE

    def match(
        self, submap: Walls, points: Array, prediction: Prediction, degenerate: Array | None = None
    ) -> GridMatch | None:
        """Return the match of a scan; None: there are too few points.

        Args:
            submap: What it is matched on.
            points: (N, 2) robot frame [m].
            prediction: Where the odometry expects it.
            degenerate: (2,) direction that is left to the odometry, robot frame, as `degenerate_direction` returns it.
        """
        if len(points) < self._config.min_points:
            return None
        return self._match(submap, points, prediction, degenerate)

    def match_anyhow(
        self, submap: Walls, points: Array, prediction: Prediction, degenerate: Array | None = None
    ) -> GridMatch | None:
        """Return as `match`; where the scan fits much worse than usual, as if the wheels had slipped.

        Then it is searched for with `retry_sigmas` times the odometry's standard deviations, and what wheels slip at
        rest. What it finds counts where the score is good enough.
        """
        match = self.match(submap, points, prediction, degenerate)
        if match and self.is_poor(match):
            wide = Prediction(prediction.pose, self._config.retry_sigmas * prediction.sigma + _SLIP)
            again = self._match(submap, points, wide, degenerate)
            good = again.score >= self._config.retry_found * self._typical_score
            match = replace(again, retried=True) if good else match
        return match

    def search(self, submap: Walls, points: Array, anywhere: Prediction) -> list[GridMatch]:
        """Return the matches of a scan at the places where it fits best, wherever the robot may be.

        Args:
            submap: What it is matched on.
            points: (N, 2) robot frame [m].
            anywhere: The middle of the window, and half its sides as `sigma`.

        Returns:
            Some of them may be of the same place.
        """
        thinned = points[:: max(1, len(points) // self._config.search_points)]
        step = heading_step(submap.resolution, points)
        place = submap.field, submap.corner, submap.resolution
        linear, angular = anywhere.sigma.tolist()
        least = self._config.explained * self._config.beside * self._typical_score
        starts = search_widely(*place, thinned, anywhere.pose, linear, angular, step, least)
        found = [self._match(submap, points, Prediction(start, anywhere.sigma), None) for start in starts]
        return [replace(match, retried=True) for match in found]

    def believe(self, match: GridMatch) -> None:
        """Learn from a match that holds which scores are typical."""
        self._typical_score += _SCORE_MEMORY * (match.score - self._typical_score)

    def is_beside(self, match: GridMatch) -> bool:
        """Return whether a scan sees hardly anything of what it was matched on."""
        return match.score < self._config.beside * self._typical_score and match.seen < self._config.beside

    def is_poor(self, match: GridMatch) -> bool:
        """Return whether a match is so bad that the robot may well be elsewhere."""
        return match.score < self._config.retry_below * self._typical_score * match.seen

    def explains(self, match: GridMatch) -> bool:
        """Return whether a match is so good that it tells where the robot is, even far from where it was expected."""
        seen = max(match.seen, self._config.beside)
        return match.score >= self._config.explained * self._typical_score * seen

    def cost(self, match: GridMatch | None, points: int) -> float:
        """Return the negative log-likelihood of a scan where it was matched, up to a constant.

        The scan counts for so many `points` as `independent` says.
        What lies where nothing is known counts as a point that fits as usual or not at all, either as likely. A `match`
        of None is that of a scan of which nothing is known.
        """
        score, seen = (match.score, match.seen) if match else (0.0, 0.0)
        missed = seen - score + (1.0 - seen) * (1.0 - _UNKNOWN * self._typical_score)
        return _COMPARED * self._config.weight * points * missed

    def independent(self, points: Array) -> int:
        """Return for how many points that err independently those of a scan (N, 2) count."""
        return min(len(voxel_first(points, self._config.apart)), self._config.independent)

    def _match(self, submap: Walls, points: Array, prediction: Prediction, degenerate: Array | None) -> GridMatch:
        config = self._config
        each = config.weight * self.independent(points) / len(points)
        reach, angles, step = self._window(submap.resolution, points, prediction)
        prior, information = prediction.pose, prediction.information
        if degenerate is not None and degenerate.any():
            direction = transform_points((0.0, 0.0, prior[2]), degenerate[None])[0]
            information[:2, :2] += _TRUSTED * information[0, 0] * np.outer(direction, direction)
        place = (submap.field, submap.corner, submap.resolution)
        start = prior
        if reach or angles:
            thinned = points[:: max(1, len(points) // config.search_points)]
            weight = _COMPARED * each * len(points) / len(thinned)
            start, _ = correlate(*place, thinned, prior, information, weight, reach, angles, step)
        pose, curvature, rest, _ = refine_pose(*place, points, start, prior, information, each, config.iterations)
        pose[2] = wrap_one(pose.item(2))
        score, searched = 1.0 - rest / len(points), bool(reach or angles)
        return GridMatch(pose, curvature, score, searched)

    def _window(self, resolution: float, points: Array, prediction: Prediction) -> tuple[int, int, float]:
        """Return cells, angle steps to each side and the step [rad]; zeros where the least squares alone will do."""
        config = self._config
        linear, angular = (config.sigmas * prediction.sigma).tolist()
        linear, angular = min(linear, config.max_linear), min(angular, config.max_angular)
        far = far_radius(points)
        if linear + angular * far <= config.capture:
            return 0, 0, 0.0
        step = resolution / max(far, 1.0)
        reach, angles = math.ceil(linear / resolution), math.ceil(angular / step)
        poses = (2 * reach + 1) ** 2 * (2 * angles + 1)
        if poses > _MOST_POSES:
            raise InputError(
                f"scans would be searched for at {poses} poses each, more than {_MOST_POSES}; `max_linear` or "
                "`max_angular` is too large, or the cells are too small"
            )
        return reach, angles, step


def heading_step(resolution: float, points: Array) -> float:
    """Return the step between headings that are searched [rad]: one that moves far `points` (N, 2) by a cell [m].

    It is no finer than searches take: 50 m away and beyond that is more than a cell, and the least squares come after.
    """
    return max(resolution / max(far_radius(points), 1.0), FINEST_STEP)


@kernel
def far_radius(points: Array) -> float:
    """Return the distance from the origin [m] that 80 % of `points` (N, 2) keep: how far out a turn moves them."""
    squares = points[:, 0] * points[:, 0] + points[:, 1] * points[:, 1]
    at = 0.8 * (len(points) - 1)
    low = int(at)
    high = min(low + 1, len(points) - 1)
    ordered = np.partition(squares, high)
    below = ordered[:high].max() if high > low else ordered[low]
    return np.sqrt(below + (at - low) * (ordered[high] - below))
