"""The genetic search over poses, one for PGA, GLASM and GLASM-g: they differ in their fitness alone."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from ..bounds import Seed, Share, Within, check_numbers
from ..errors import InputError
from ..view_kernel import kernel
from .fitness import lookup_fitness, polar_fitness

LOOKUP, POLAR = 0, 1
DRAWS = 12  # random numbers that one child takes


@dataclass(frozen=True, kw_only=True)
class GeneticConfig:
    """Search space and genetic parameters (Table 1; what the paper leaves open is documented here, one set for all).

    Genes are real numbers (x, y, theta), not bits. The parents of a child win tournaments; the child lies on or near
    the segment between them (blend crossover), then mutates by a Gaussian that narrows from generation to generation;
    the best individual survives. On a full circle headings wrap.

    Attributes:
        linear: Half the side of the square of translations around the guess [m].
        angular: Half the range of headings around the guess [rad]; pi: the full circle.
        population: Individuals.
        generations: Times the population is scored; the first is the random one.
        runs: Independent searches, of which the best counts.
        tournament: How many draw for each place as a parent.
        blend: How far beyond its parents a child may lie, in their distance.
        mutation: Standard deviation of the first generation's mutation, as a share of the half ranges.
        narrowing: What it is multiplied by from one generation to the next.
        seed: Seed of the random numbers; the same for every match, so equal questions have equal answers.
    """

    linear: Annotated[float, Within(0.0, 1e3)]
    angular: float
    population: Annotated[int, Within(2, 10_000)]
    generations: Annotated[int, Within(1, 1000)]
    runs: Annotated[int, Within(1, 100)] = 1
    tournament: int = 3
    blend: Annotated[float, Within(0.0, 100.0)] = 0.3
    mutation: Annotated[float, Within(0.0, 100.0)] = 0.25
    narrowing: Share = 0.7
    seed: Seed = 0

    def __post_init__(self) -> None:
        check_numbers(self)
        if not (self.linear > 0.0 and 0.0 < self.angular <= np.pi + 1e-9):
            raise InputError(f"need `linear` > 0 [m] and `angular` in (0, pi] [rad], got {self.linear}, {self.angular}")
        if not (self.population >= 2 and self.generations >= 1 and self.runs >= 1 and 1 <= self.tournament <= 4):
            raise InputError(
                "need `population` >= 2, `generations` >= 1, `runs` >= 1, `tournament` in 1 .. 4, got "
                f"{self.population}, {self.generations}, {self.runs}, {self.tournament}"
            )
        if not (self.blend >= 0.0 and self.mutation >= 0.0 and 0.0 < self.narrowing <= 1.0):
            raise InputError(f"`blend`, `mutation` must not be negative, `narrowing` in (0, 1], got {self}")


SMALL = GeneticConfig(linear=0.3, angular=np.radians(17.2), population=20, generations=6)
MEDIUM = GeneticConfig(linear=1.0, angular=np.radians(57.3), population=100, generations=10)
LARGE = GeneticConfig(linear=2.0, angular=np.pi, population=200, generations=12, runs=2)
SIZES = {"small": SMALL, "medium": MEDIUM, "large": LARGE}


def draw(config: GeneticConfig) -> NDArray[np.float32]:
    """Return (runs, generations, population, DRAWS) random numbers for `evolve`; the last three are Gaussian."""
    rng = np.random.default_rng(config.seed)
    numbers = rng.random((config.runs, config.generations, config.population, DRAWS), dtype=np.float32)
    numbers[..., -3:] = rng.standard_normal((*numbers.shape[:-1], 3), dtype=np.float32)
    return numbers


@kernel
def score_population(kind, poses, points, table, fitness):  # pragma: no cover
    """Score `poses` (P, 3); `table` = (values, x0, y0, cell, ranges, start, step, threshold)."""
    if kind == LOOKUP:
        lookup_fitness(poses, points, table[0], table[1], table[2], table[3], fitness)
    else:
        polar_fitness(poses, points, table[4], table[5], table[6], table[7], fitness)


@kernel
def pick(fitness, draws, first, tournament):  # pragma: no cover
    """Return the winner of a tournament among the individuals that `draws[first:]` name."""
    best = int(draws[first] * len(fitness))
    for t in range(1, tournament):
        other = int(draws[first + t] * len(fitness))
        if fitness[other] > fitness[best]:
            best = other
    return best


@kernel
def bear(child, mother, father, half, blend, spread, draws):  # pragma: no cover
    """Write the `child` (3,) of two poses, relative to the centre of the box of half widths `half` (3,)."""
    along = draws[8] * (1.0 + 2.0 * blend) - blend
    for gene in range(3):
        apart = father[gene] - mother[gene]
        circle = gene == 2 and half[2] >= np.pi - 1e-6
        if circle:
            apart -= 2.0 * np.pi * np.floor(apart / (2.0 * np.pi) + 0.5)
        value = mother[gene] + along * apart + spread * half[gene] * draws[9 + gene]
        if circle:
            value -= 2.0 * np.pi * np.floor(value / (2.0 * np.pi) + 0.5)
        child[gene] = min(max(value, -half[gene]), half[gene])


@kernel
def evolve(kind, points, table, centre, half, numbers, tournament, blend, mutation, narrowing):  # pragma: no cover
    """Return (populations (runs, generations, P, 3), fitness (runs, generations, P)), the whole history of the search.

    Args:
        kind: LOOKUP or POLAR.
        points: (N, 2) of the new scan.
        table: See `score_population`.
        centre: (3,) of the search space.
        half: (3,) its half widths.
        numbers: From `draw`.
        tournament, blend, mutation, narrowing: See `GeneticConfig`.
    """
    runs, generations, size, _ = numbers.shape
    history, fitness = np.empty((runs, generations, size, 3)), np.empty((runs, generations, size))
    genes, children = np.empty((size, 3)), np.empty((size, 3))
    for run in range(runs):
        for p in range(size):
            for gene in range(3):
                genes[p, gene] = (2.0 * numbers[run, 0, p, gene] - 1.0) * half[gene]
        spread = mutation
        for generation in range(generations):
            if generation > 0:
                before = fitness[run, generation - 1]
                children[0] = genes[np.argmax(before)]
                for p in range(1, size):
                    draws = numbers[run, generation, p]
                    mother, father = pick(before, draws, 0, tournament), pick(before, draws, 4, tournament)
                    bear(children[p], genes[mother], genes[father], half, blend, spread, draws)
                genes, children = children, genes
                spread *= narrowing
            history[run, generation] = genes + centre
            score_population(kind, history[run, generation], points, table, fitness[run, generation])
    return history, fitness
