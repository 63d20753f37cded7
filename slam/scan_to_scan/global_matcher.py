"""The matcher with a guarantee: the best pose of the whole window by branch and bound, then robust refinement.

The window is searched exactly on the lookup table of GLASM-g, so no population can miss its maximum; a few further
maxima are refined too, and the one wins that explains both scans best, free space included. Where even that one
explains them badly, as for views that share little, a second exact search scores free space as well: a point where the
reference saw nothing is worth most of a hit, a point where it saw free space nothing. How well a pose explains two
views is counted by range, not by beams: of a corridor's two ends and many doors the far points tell which is which.
"""

from dataclasses import dataclass, field, replace
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..bounds import Reach, Share, Within, check_numbers, checked_pose
from ..errors import InputError
from ..geometry import compose, inverse, wrap_angle
from ..scan import LaserScan
from ..search.branch_and_bound import Maximum, SearchResult, SearchWindow, Separation, branch_and_bound
from ..search.score_pyramid import ScoreGrid, ScorePyramid, build_pyramid
from .iterative import PLICP, IterativeConfig, IterativeMatcher, Refined
from .lookup import LookupConfig, build_lookup
from .match import Match
from .shared_lines import SharedLinesConfig, refine_by_shared_lines
from .surfaces import SurfaceConfig, Surfaces, every_second, find_surfaces, near_points, noise_of
from .visibility import agreement, mark_unseen

# The whole circle and the large space of HGLASM-g.
_WINDOW = SearchWindow(linear=2.0, angular=np.pi, angular_step=np.radians(2.0))
_SEPARATION = Separation(linear=0.4, angular=0.2, least_share=0.85)
_SECOND_SEPARATION = Separation(linear=0.3, angular=0.2, least_share=0.5)
# Lines of both scans count, so fewer neighbours agreeing better serve: 7 mm is what a SICK's noise leaves. A line
# across a gap between two surfaces is worse than none, so points side by side are linked more strictly than elsewhere.
_REFINEMENT = replace(
    PLICP,
    first_reach=0.6,
    last_reach=0.5,
    first_scale=0.3,
    last_scale=0.015,
    surfaces=SurfaceConfig(neighbours=3, tolerance=0.007, obliquity=3.5),
)


_SCOUTS, _SCOUT_STEPS = 3, 6  # every third point, six steps: which maxima of the second search are promising
_BEYOND_DOUBT = 0.96  # of the best score there is: enough, whatever the scans let one expect
_NEARLY = 0.97  # of the most worth: less than that, and of poses side by side from different views one is better
_NOTHING = 1e-9  # [m] what returns that all lie at the laser itself count
_LEVELS = 4  # of noise: 1, 2, 4 and 8 times that of a SICK


@dataclass(frozen=True, kw_only=True)
class GlobalConfig:
    """Parameters of the global matcher.

    Attributes:
        window: What is searched around the guess.
        top_level: The search starts from blocks of 2^top_level cells.
        lookup: The table.
        maxima: How many maxima are refined at most.
        separation: When a further maximum counts.
        points: Most points that the search scores (the refinement uses all); evenly picked.
        sigma: Of the final score's hits [m].
        margin: How much nearer than the seen surface a point must be to contradict it [m].
        free_space: What a contradiction counts against a hit.
        whole: What it counts if one scan is explained as a whole.
        rival: Another pose that reaches this share of the best final score makes the match ambiguous.
        sure: A final score that makes the second search needless, as a share of how well the odd beams of each scan
            explain its even ones: leaves and chair legs look different to every beam.
        endpoints: What the share that a pose's maximum has in the first search counts, if that search is enough: the
            views are alike then, and every point counts the same there.
        unseen: Worth in the second search of a point where the reference saw nothing, in [0, 1].
        beyond: How far beyond the reference's table such points count [m].
        second_maxima: How many maxima of the second search are looked at, at most; 0: there is none.
        second_refined: How many of them are refined, those that explain the scans best after a few steps.
        second_separation: When a further maximum of the second search counts.
        far: What a pose counts less, if there was a second search, for each square metre of its squared distance from
            the guess: of two that explain the scans as well, the nearer one is taken.
        beside: Poses within this (m, rad) are one answer.
        noise: Of the points that `refinement` is made for [m]. Where theirs is 2, 4, 8 times that, its tolerance,
            its gap, its last scale, `sigma` and the lengths of `shared` are larger.
        refinement: PL-ICP with the lines of both scans, from each maximum; of the pose that is taken once more, lines
            that reach equally far to both sides beside them.
        shared: The last step, to where both scans lie on the same straight pieces.
    """

    window: SearchWindow = _WINDOW
    top_level: Annotated[int, Within(0, 8)] = 3
    lookup: LookupConfig = field(default_factory=LookupConfig)
    maxima: Annotated[int, Within(1, 1000)] = 3
    separation: Separation = _SEPARATION
    points: Annotated[int, Within(1, 10_000)] = 180
    sigma: float = 0.05
    margin: Reach = 0.3
    free_space: float = 0.5
    whole: float = 0.5
    rival: float = 0.9
    sure: float = 1.0
    endpoints: float = 0.5
    unseen: Share = 0.78
    beyond: Annotated[float, Within(0.0, 100.0)] = 4.0
    second_maxima: Annotated[int, Within(0, 1000)] = 40
    second_refined: Annotated[int, Within(1, 1000)] = 16
    second_separation: Separation = _SECOND_SEPARATION
    far: float = 0.01
    beside: tuple[float, float] = (0.2, 0.04)
    noise: float = 0.007
    refinement: IterativeConfig = _REFINEMENT
    shared: SharedLinesConfig = field(default_factory=SharedLinesConfig)

    def __post_init__(self) -> None:
        check_numbers(self)
        if not (self.maxima >= 1 and self.points >= 1 and min(self.sigma, self.noise) > 0.0 and self.margin >= 0.0):
            raise InputError(f"need `maxima`, `points` >= 1, `sigma`, `noise` > 0, `margin` >= 0, got {self}")
        if not (0.0 <= self.unseen <= 1.0 and self.beyond >= 0.0 and self.second_maxima >= 0):
            raise InputError(f"need `unseen` in [0, 1], `beyond` [m], `second_maxima` >= 0, got {self}")
        if not (self.second_refined >= 1 and min(self.sure, self.far, self.endpoints) >= 0.0):
            raise InputError(f"need `second_refined` >= 1, `sure`, `far`, `endpoints` >= 0, got {self}")


class GlobalMatcher:
    """Searches the whole window exactly, refines the best maxima, takes the one that explains both scans."""

    def __init__(self, config: GlobalConfig) -> None:
        self.config = config
        self._refinements = [IterativeMatcher(_coarser(config.refinement, 2**k)) for k in range(_LEVELS)]
        self._shared = [config.shared.coarser(2**k) for k in range(_LEVELS)]
        self._reference: LaserScan | None = None
        self._pyramid: ScorePyramid | None = None

    def match(self, reference: LaserScan, new: LaserScan, guess: ArrayLike) -> Match:
        """Return the pose of `new` in the frame of `reference`, from `guess` (3,) (see `Matcher`)."""
        config = self.config
        level, surfaces_new = self._level(reference, new)
        tool = self._refinements[level]
        points, centre = surfaces_new.points, checked_pose(guess, "guess")
        found = self.search(reference, points, centre)
        if not found.maxima or len(tool.surfaces(reference)) < 3:
            return tool.judge(reference, points, Refined(centre, 0, False))
        refined, scores = self._refine(tool, reference, surfaces_new, found)
        maxima, looked_at, nearly = found.maxima, found.looked_at, 0.0
        worth = np.array(scores) + config.endpoints * np.array([maximum.score for maximum in maxima])
        if config.second_maxima > 0 and not self._is_sure(tool, tool.surfaces(reference), surfaces_new, max(scores)):
            second = self.search_views(reference, points, centre)
            second = replace(second, maxima=self._most_promising(tool, reference, surfaces_new, second.maxima))
            more, more_scores = self._refine(tool, reference, surfaces_new, second)
            refined, scores = refined + more, scores + more_scores
            maxima, looked_at = maxima + second.maxima, looked_at + second.looked_at
            off = np.array([pose.pose[:2] for pose in refined]) - centre[:2]
            worth, nearly = np.array(scores) - config.far * (off**2).sum(axis=1), _NEARLY
        first = self._choose(refined, worth, nearly)
        best = tool.polish_both(reference, surfaces_new, refined[first], replace(tool.config.surfaces, even=True))
        settled = refine_by_shared_lines(tool.surfaces(reference).points, points, best.pose, self._shared[level])
        best = replace(best, pose=settled)
        order = np.argsort(-np.array(scores), kind="stable")
        others = [refined[k].pose for k in order if self._rivals(best, refined[k], scores[first], scores[k])]
        match = tool.judge(reference, points, best)
        return replace(
            match,
            converged=match.converged and not others,
            evaluations=looked_at,
            ambiguous=bool(others),
            alternatives=np.array(others).reshape(-1, 3),
            searched=np.array(maxima[first].pose),
        )

    def search(self, reference: LaserScan, points_new: NDArray[np.float64], guess: ArrayLike) -> SearchResult:
        """Return the maxima of the window around `guess` (3,) for points (N, 2) of the new scan."""
        return self._search(self.pyramid(reference), points_new, guess, self.config.maxima, self.config.separation)

    def search_views(self, reference: LaserScan, points_new: NDArray[np.float64], guess: ArrayLike) -> SearchResult:
        """Return the same of the second search, which scores free space as well."""
        config = self.config
        pyramid = self._pyramid_over(self.views_table(reference))
        return self._search(pyramid, points_new, guess, config.second_maxima, config.second_separation)

    def pyramid(self, reference: LaserScan) -> ScorePyramid:
        """Return the pyramid over the reference's table, that of the last call if it is the same object."""
        if self._pyramid is None or self._reference is not reference:
            config = self.config
            grid = build_lookup(near_points(reference, config.refinement.surfaces.range_limit), config.lookup)
            self._pyramid = self._pyramid_over(grid)
            self._reference = reference
        return self._pyramid

    def views_table(self, reference: LaserScan) -> ScoreGrid:
        """Return the reference's table, wider, in which what it did not see has a worth."""
        config, seen = self.config, self._refinements[0].surfaces(reference)
        grid = build_lookup(seen.points, config.lookup)
        border = int(np.ceil(config.beyond / grid.resolution))
        values = np.pad(grid.values, border)
        x0, y0 = (start - border * grid.resolution for start in grid.origin)
        worth = np.uint8(round(255.0 * config.unseen))
        mark_unseen(seen.points, seen.rays, x0, y0, grid.resolution, config.margin, worth, values)
        return ScoreGrid(values, (x0, y0), grid.resolution)

    def _pyramid_over(self, grid: ScoreGrid) -> ScorePyramid:
        config = self.config
        margin = config.window.reach(grid.resolution) + (1 << config.top_level)
        return build_pyramid(grid, top_level=config.top_level, margin=margin)

    def _search(
        self,
        pyramid: ScorePyramid,
        points_new: NDArray[np.float64],
        guess: ArrayLike,
        maxima: int,
        separation: Separation,
    ) -> SearchResult:
        config = self.config
        if len(points_new) > config.points:
            points_new = points_new[np.linspace(0, len(points_new) - 1, config.points).astype(np.int64)]
        return branch_and_bound(pyramid, points_new, guess, config.window, maxima=maxima, separation=separation)

    def _level(self, reference: LaserScan, new: LaserScan) -> tuple[int, Surfaces]:
        """Return which refinement is made for the noise of these scans, and the surfaces of the new one for it."""
        finest, surfaces = self._refinements[0], find_surfaces(new, self.config.refinement.surfaces)
        noise = 0.5 * (noise_of(finest.surfaces(reference)) + noise_of(surfaces))
        level = min(round(np.log2(max(noise / self.config.noise, 1.0))), _LEVELS - 1)
        return level, find_surfaces(new, self._refinements[level].config.surfaces) if level > 0 else surfaces

    def _refine(
        self, tool: IterativeMatcher, reference: LaserScan, new: Surfaces, found: SearchResult
    ) -> tuple[list[Refined], list[float]]:
        """Return the refined maxima and how well each explains both scans."""
        refined = [tool.refine_both(reference, new, maximum.pose) for maximum in found.maxima]
        seen = tool.surfaces(reference)
        return refined, [self._explains(tool, seen, new, candidate.pose) for candidate in refined]

    def _explains(self, tool: IterativeMatcher, reference: Surfaces, new: Surfaces, pose: NDArray[np.float64]) -> float:
        """Return how well two scans explain each other at a pose, in [0, 1].

        The share of hits among what both could see of each other, hits and contradictions (and a fifth of the
        reference's points, so that a few hits at the rim do not win), plus `whole` times the share of hits of the scan
        that has more of them: of two views the nearer one shows part of what the farther one shows, all of it, and
        along a corridor little else tells where. A point counts its range (see `agreement`).
        """
        config = self.config
        sigma = max(config.sigma, 2.0 * tool.config.last_scale)
        hits, against, most, whole = 0.0, 0.0, 0.0, 0.0
        for points, T, seen in ((new, pose, reference), (reference, inverse(pose), new)):
            met, contradicted, most = agreement(
                points.points, T, seen.points, seen.rays, seen.feet, seen.normals, seen.first,
                sigma, config.margin,
            )  # fmt: skip
            hits, against, whole = hits + met, against + contradicted, max(whole, met / max(most, _NOTHING))
        # `most` is now what the reference's points count.
        both = hits / max(hits + config.free_space * against + 0.2 * most, _NOTHING)
        return float((both + config.whole * whole) / (1.0 + config.whole))

    def _most_promising(
        self, tool: IterativeMatcher, reference: LaserScan, new: Surfaces, maxima: tuple[Maximum, ...]
    ) -> tuple[Maximum, ...]:
        """Return the `second_refined` maxima that explain the scans best after a few steps of a third of the points."""
        seen = tool.surfaces(reference)
        few = np.ascontiguousarray(new.points[::_SCOUTS])
        poses = [tool.refine(reference, few, maximum.pose, most=_SCOUT_STEPS).pose for maximum in maxima]
        scores = np.array([self._explains(tool, seen, new, pose) for pose in poses])
        best = np.sort(np.argsort(-scores, kind="stable")[: self.config.second_refined])
        return tuple(maxima[k] for k in best)

    def _is_sure(self, tool: IterativeMatcher, reference: Surfaces, new: Surfaces, score: float) -> bool:
        """Return whether a score is as good as the scans let one expect."""
        config = self.config
        # A hit of every point, among those and a fifth of the reference's.
        first, second = (float((points.points * points.rays).sum()) for points in (reference, new))
        most = (first + second) / (1.2 * first + second)
        most = (most + config.whole) / (1.0 + config.whole)
        return score >= _BEYOND_DOUBT * most or score >= config.sure * self._expected(tool, reference, new)

    def _expected(self, tool: IterativeMatcher, reference: Surfaces, new: Surfaces) -> float:
        """Return the mean score of a scan's odd points against its even ones, which is what a right pose may reach."""
        scores = []
        for surfaces in (reference, new):
            odd, even = (every_second(surfaces, side, tool.config.surfaces) for side in (0, 1))
            enough = min(len(odd), len(even)) >= 3
            scores.append(self._explains(tool, odd, even, np.zeros(3)) if enough else 1.0)
        return float(np.mean(scores))

    def _choose(self, refined: list[Refined], worth: NDArray[np.float64], nearly: float) -> int:
        """Return the index of the pose of most worth; of those beside it, that of the highest maximum.

        That one has to be worth `nearly` as much, as a share. Between poses a hand's breadth apart the share of
        explained points decides little: sparse points like to meet one beam aside.
        """
        best = int(np.argmax(worth))
        linear, angular = self.config.beside
        for k in range(best):
            apart = compose(inverse(refined[best].pose), refined[k].pose)
            beside = np.hypot(apart[0], apart[1]) <= linear and abs(wrap_angle(apart[2])) <= angular
            if beside and worth[k] >= nearly * worth[best]:
                return k
        return best

    def _rivals(self, best: Refined, other: Refined, best_score: float, score: float) -> bool:
        """Return whether `other` is a different pose that is about as good."""
        apart = compose(inverse(best.pose), other.pose)
        separation = self.config.separation
        far = np.hypot(apart[0], apart[1]) > separation.linear or abs(wrap_angle(apart[2])) > separation.angular
        return bool(far and score >= self.config.rival * best_score)


def _coarser(config: IterativeConfig, factor: float) -> IterativeConfig:
    """Return the refinement for `factor` times the noise."""
    last, surfaces = min(factor * config.last_scale, config.first_scale), config.surfaces
    surfaces = replace(surfaces, tolerance=factor * surfaces.tolerance, gap=factor * surfaces.gap)
    return replace(config, last_scale=last, surfaces=surfaces)
