"""PGA, GLASM, GLASM-g and HGLASM-g: a genetic search, then (HGLASM-g) MbICP from its best individual."""

from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..bounds import check_numbers, checked_pose
from ..errors import InputError
from ..geometry import wrap_angle
from ..scan import LaserScan
from .genetic import LARGE, LOOKUP, POLAR, GeneticConfig, draw, evolve
from .iterative import MBICP, PLICP, IterativeConfig, IterativeMatcher, Refined
from .lookup import LookupConfig, build_lookup
from .match import Match
from .surfaces import near_points

_POLISHING = replace(PLICP, first_reach=0.5, first_scale=0.2)

_COARSE = (0.1, 0.1, 0.035)  # standard deviation of a search that nothing refines: a cell of the table [m, m, rad]
_BLIND = 0.5  # standard deviation of a direction that the scans say nothing about [m]


@dataclass(frozen=True, kw_only=True)
class HybridConfig:
    """Parameters of a genetic matcher.

    Attributes:
        fitness: "lookup" (GLASM, GLASM-g by the table's pattern) or "polar" (PGA).
        genetic: The search space and the genetic parameters.
        lookup: The table.
        polar_threshold: Ranges that differ by less correspond, in PGA [m].
        refine: Whether MbICP follows (HGLASM-g).
        polish: Whether PL-ICP follows MbICP; not in the paper.
        refinement: MbICP.
        polishing: PL-ICP; its surfaces and confidence serve the match's score and covariance too.
    """

    fitness: Literal["lookup", "polar"] = "lookup"
    genetic: GeneticConfig = LARGE
    lookup: LookupConfig = field(default_factory=LookupConfig)
    polar_threshold: float = 0.5
    refine: bool = True
    polish: bool = False
    refinement: IterativeConfig = MBICP
    polishing: IterativeConfig = _POLISHING

    def __post_init__(self) -> None:
        check_numbers(self)
        if self.fitness not in ("lookup", "polar"):
            raise InputError(f'`fitness` must be "lookup" or "polar", got {self.fitness!r}')
        if not self.polar_threshold > 0.0:
            raise InputError(f"`polar_threshold` must be positive [m], got {self.polar_threshold}")


@dataclass(frozen=True, eq=False)
class Search:
    """What the genetic search found.

    Attributes:
        pose: (3,) the best individual.
        fitness: Its fitness, in [0, 1].
        evaluations: Poses scored.
        populations: (runs, generations, population, 3) all individuals.
        fitnesses: (runs, generations, population) theirs.
    """

    pose: NDArray[np.float64]
    fitness: float
    evaluations: int
    populations: NDArray[np.float64]
    fitnesses: NDArray[np.float64]


class HybridMatcher:
    """Searches the space around the guess genetically, then refines."""

    def __init__(self, config: HybridConfig) -> None:
        self.config = config
        self._numbers = draw(config.genetic)
        self._refinement = IterativeMatcher(config.refinement)
        self._polishing = IterativeMatcher(config.polishing)
        self._reference: LaserScan | None = None
        self._table: tuple = ()

    def match(self, reference: LaserScan, new: LaserScan, guess: ArrayLike) -> Match:
        """Return the pose of `new` in the frame of `reference`, from `guess` (3,) (see `Matcher`)."""
        points = near_points(new, self.config.refinement.surfaces.range_limit)
        found = self.search(reference, points, guess)
        refined = Refined(found.pose, 0, True)
        if self.config.refine:
            refined = self._refinement.refine(reference, points, found.pose)
        if self.config.polish:
            coarse = refined
            refined = self._polishing.refine(reference, points, coarse.pose)
            refined = replace(refined, iterations=refined.iterations + coarse.iterations)
        match = self._refinement.judge(reference, points, refined)
        covariance = match.covariance
        if not (self.config.refine or self.config.polish):
            covariance = covariance + np.diag(np.square(_COARSE))
        # What constrains one direction only, as a corridor, looks the same from behind.
        turnable = self.config.genetic.angular > 0.5 * np.pi and covariance[:2, :2].trace() > _BLIND**2
        return replace(
            match,
            covariance=covariance,
            converged=match.converged and not turnable,
            ambiguous=turnable,
            evaluations=found.evaluations,
            searched=found.pose,
        )

    def search(self, reference: LaserScan, points_new: NDArray[np.float64], guess: ArrayLike) -> Search:
        """Return the best individual of the search around `guess` (3,) for points (N, 2) of the new scan."""
        config, genetic = self.config, self.config.genetic
        centre = checked_pose(guess, "guess")
        if len(points_new) == 0 or not reference.is_return.any():
            return Search(centre, 0.0, 0, np.empty((0, 0, 0, 3)), np.empty((0, 0, 0)))
        populations, fitnesses = evolve(
            LOOKUP if config.fitness == "lookup" else POLAR,
            points_new,
            self.table(reference),
            centre,
            np.array([genetic.linear, genetic.linear, genetic.angular]),
            self._numbers,
            genetic.tournament,
            genetic.blend,
            genetic.mutation,
            genetic.narrowing,
        )
        best = np.unravel_index(int(np.argmax(fitnesses)), fitnesses.shape)
        pose = populations[best].copy()
        pose[2] = wrap_angle(pose[2])
        return Search(pose, float(fitnesses[best]), fitnesses.size, populations, fitnesses)

    def table(self, reference: LaserScan) -> tuple:
        """Return what the fitness needs of the reference, that of the last call if it is the same object."""
        if self._reference is not reference:
            limit = self.config.refinement.surfaces.range_limit
            grid = build_lookup(near_points(reference, limit), self.config.lookup)
            ranges = np.where(reference.is_return & (reference.ranges <= limit), reference.ranges, np.nan)
            start = float(reference.bearings[0])
            step = float((reference.bearings[-1] - start) / max(len(reference) - 1, 1)) or 1.0
            self._table = (
                grid.values,
                *grid.origin,
                grid.resolution,
                ranges,
                start,
                step,
                self.config.polar_threshold,
            )
            self._reference = reference
        return self._table
