"""The iterative matchers: ICP, PL-ICP (Censi 2008) and MbICP (Minguez, Montesano, Lamiraux 2006)."""

from dataclasses import dataclass, field, replace
from typing import Annotated, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..bounds import Rounds, Share, Within, check_numbers, checked_pose
from ..errors import InputError
from ..geometry import wrap_angle
from ..scan import LaserScan
from .confidence import ConfidenceConfig, assess
from .match import Match
from .registration import LINE, METRIC, POINT, register
from .surfaces import SurfaceConfig, Surfaces, find_surfaces, near_points, relined
from .symmetric import register_both

_NO_LINES = (*(np.empty((0, 2)) for _ in range(4)), np.empty(0, dtype=np.bool_), np.empty(0, dtype=np.int32))
_KINDS = {"point": POINT, "line": LINE, "metric": METRIC}


@dataclass(frozen=True, kw_only=True)
class IterativeConfig:
    """Parameters of an iterative matcher; the reach and the scale shrink by `factor` from step to step.

    Attributes:
        kind: What a correspondence measures: "point" (ICP), "line" (PL-ICP), "metric" (MbICP).
        lever: MbICP's L, how many metres a radian is worth [m]; the others have no use for it.
        first_reach: Largest distance of a correspondence at the start [m].
        last_reach: Largest distance of a correspondence in the end [m].
        first_scale: Scale of the robust (Geman-McClure) weight at the start [m].
        last_scale: The same in the end [m].
        factor: What both are multiplied by after each step.
        kept: Share of the correspondences that are kept, nearest first.
        ridge: Damping relative to the weight of the points: blind directions keep the guess.
        most_iterations: Steps at most.
        rest: A step below this [m, rad] ends the loop.
        surfaces: How lines are fitted to the reference.
        confidence: What makes a pose believed.
    """

    kind: Literal["point", "line", "metric"] = "line"
    lever: float = 3.0
    first_reach: float = 1.0
    last_reach: float = 0.3
    first_scale: float = 0.5
    last_scale: float = 0.05
    factor: Annotated[float, Within(1e-3, 1.0)] = 0.5
    kept: Share = 1.0
    ridge: float = 1e-3
    most_iterations: Rounds = 40
    rest: float = 1e-4
    surfaces: SurfaceConfig = field(default_factory=SurfaceConfig)
    confidence: ConfidenceConfig = field(default_factory=ConfidenceConfig)

    def __post_init__(self) -> None:
        check_numbers(self)
        if self.kind not in _KINDS:
            raise InputError(f"`kind` must be one of {', '.join(_KINDS)}, got {self.kind!r}")
        if not (0.0 < self.kept <= 1.0 and 0.0 < self.factor <= 1.0):
            raise InputError(f"`kept` and `factor` must be in (0, 1], got {self.kept} and {self.factor}")
        if not (0.0 < self.last_reach <= self.first_reach and 0.0 < self.last_scale <= self.first_scale):
            raise InputError(f"reach and scale [m] must be positive and not grow, got {self}")
        if not (self.lever > 0.0 and self.rest > 0.0 and self.ridge >= 0.0 and self.most_iterations >= 1):
            raise InputError(f"`lever`, `rest`, `most_iterations` must be positive, `ridge` not negative, got {self}")


ICP = IterativeConfig(kind="point", kept=0.9, last_reach=0.3, last_scale=0.1)
PLICP = IterativeConfig(kind="line")
MBICP = IterativeConfig(
    kind="metric",
    kept=0.95,
    first_reach=1.5,
    last_reach=0.5,
    first_scale=1.5,
    last_scale=0.2,
    factor=0.8,
    rest=2e-4,
)


@dataclass(frozen=True, eq=False)
class Refined:
    """Where the loop came to rest: `pose` (3,), `iterations`, and whether it did (`at_rest`)."""

    pose: NDArray[np.float64]
    iterations: int
    at_rest: bool


class IterativeMatcher:
    """Matches from a guess by repeated correspondence and least squares."""

    def __init__(self, config: IterativeConfig) -> None:
        self.config = config
        self._reference: LaserScan | None = None
        self._surfaces: Surfaces | None = None
        self._judged: LaserScan | None = None
        self._long_lines: Surfaces | None = None

    def match(self, reference: LaserScan, new: LaserScan, guess: ArrayLike) -> Match:
        """Return the pose of `new` in the frame of `reference`, from `guess` (3,) (see `Matcher`)."""
        points = near_points(new, self.config.surfaces.range_limit)
        refined = self.refine(reference, points, checked_pose(guess, "guess"))
        return self.judge(reference, points, refined)

    def surfaces(self, reference: LaserScan) -> Surfaces:
        """Return the surfaces of the reference, those of the last call if it is the same object."""
        if self._surfaces is None or self._reference is not reference:
            self._reference, self._surfaces = reference, find_surfaces(reference, self.config.surfaces)
        return self._surfaces

    def refine(
        self, reference: LaserScan, points_new: NDArray[np.float64], guess: ArrayLike, most: int | None = None
    ) -> Refined:
        """Return where the loop ends from `guess` (3,) for points (N, 2) of the new scan.

        It ends after `most` steps at the latest; None: the configured `most_iterations`.
        """
        config, surfaces = self.config, self.surfaces(reference)
        start = np.array(guess, dtype=np.float64)
        if len(surfaces) < 3 or len(points_new) < 3:
            return Refined(start, 0, False)
        pose, iterations, at_rest = register(
            _KINDS[config.kind],
            points_new,
            start,
            surfaces.arrays,
            config.lever if config.kind == "metric" else np.inf,
            (config.first_reach, config.last_reach),
            (config.first_scale, config.last_scale, config.factor),
            config.kept,
            config.ridge,
            most or config.most_iterations,
            config.rest,
        )
        pose[2] = wrap_angle(pose[2])
        return Refined(pose, int(iterations), bool(at_rest))

    def refine_both(self, reference: LaserScan, new: Surfaces, guess: ArrayLike) -> Refined:
        """Return where point-to-line matching from both sides ends: the lines of the new scan count as well."""
        config = self.config
        return self._from_both(reference, new, guess, (config.first_reach, config.first_scale), (_NO_LINES, _NO_LINES))

    def polish_both(self, reference: LaserScan, new: Surfaces, refined: Refined, lines: SurfaceConfig) -> Refined:
        """Return the same from a refined pose, with other lines through the points (`relined`) beside the usual ones.

        The errors of the two kinds of lines differ, so their mean is smaller.
        """
        config, surfaces = self.config, self.surfaces(reference)
        more = relined(surfaces, lines).arrays, relined(new, lines).arrays
        polished = self._from_both(reference, new, refined.pose, (config.last_reach, config.last_scale), more)
        return replace(polished, iterations=refined.iterations + polished.iterations)

    def _from_both(
        self,
        reference: LaserScan,
        new: Surfaces,
        guess: ArrayLike,
        start: tuple[float, float],
        more: tuple[tuple[NDArray, ...], tuple[NDArray, ...]],
    ) -> Refined:
        """Return the same from a reach and a scale [m], with more lines of both scans (`Surfaces.arrays`)."""
        config, surfaces = self.config, self.surfaces(reference)
        pose = np.array(guess, dtype=np.float64)
        if len(surfaces) < 3 or len(new) < 3:
            return Refined(pose, 0, False)
        pose, iterations, at_rest = register_both(
            pose,
            surfaces.arrays,
            new.arrays,
            *more,
            (start[0], config.last_reach),
            (start[1], config.last_scale, config.factor),
            config.ridge,
            config.most_iterations,
            config.rest,
        )
        pose[2] = wrap_angle(pose[2])
        return Refined(pose, int(iterations), bool(at_rest))

    def judge(self, reference: LaserScan, points_new: NDArray[np.float64], refined: Refined) -> Match:
        """Return the match of a refined pose, with its covariance and whether it is believed."""
        confidence = self.config.confidence
        if self._long_lines is None or self._judged is not reference:
            self._judged, self._long_lines = reference, relined(self.surfaces(reference), confidence.surfaces)
        sure = assess(points_new, refined.pose, self._long_lines, confidence)
        return Match(
            pose=refined.pose,
            covariance=sure.covariance,
            score=sure.score,
            converged=refined.at_rest and sure.believed,
            iterations=refined.iterations,
        )
