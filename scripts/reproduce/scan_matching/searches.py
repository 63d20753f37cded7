"""Cells of the genetic search alone (Figs. 4 to 6), and the exact search."""

import time
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ....slam.geometry import between
from ....slam.scan_to_scan.genetic import LARGE, SIZES, GeneticConfig
from ....slam.scan_to_scan.global_matcher import GlobalConfig, GlobalMatcher
from ....slam.scan_to_scan.hybrid import HybridConfig, HybridMatcher
from ....slam.scan_to_scan.iterative import MBICP, IterativeMatcher
from ....slam.scan_to_scan.lookup import LookupConfig, build_lookup
from ....slam.scan_to_scan.surfaces import near_points
from ....slam.search.exhaustive import exhaustive_search
from ...lab.scan_pairs import box_trials, is_success, split_trials
from ...lab.statistics import share, t_mean
from .contestants import quantiles, scans_of, spread
from .success import PRE_ANGULAR, PRE_LINEAR

ALGORITHMS = {
    "pga": HybridConfig(fitness="polar", refine=False),
    "glasm": HybridConfig(lookup=LookupConfig(pattern="square"), refine=False),
    "glasm-g": HybridConfig(refine=False),
}
_FILL = 0.95  # the guess's errors fill this share of the search space


def genetic_search(
    folder: str | None,
    sources: Sequence[str],
    algorithm: str,
    space: str,
    population: int,
    generations: int,
    trials: int,
    runs: int = 1,
) -> dict[str, Any]:
    """Return success, errors and time of a genetic search without refinement, the guess anywhere in its space.

    Args:
        folder: Of the logs; None: simulated scans.
        sources: The logs; each gives an equal share of the trials.
        algorithm: One of `ALGORITHMS`.
        space: "small", "medium" or "large".
        population: Individuals.
        generations: Generations.
        trials: How many.
        runs: Independent searches, of which the best counts.
    """
    genetic = replace(SIZES[space], population=population, generations=generations, runs=runs)
    matcher = HybridMatcher(replace(ALGORITHMS[algorithm], genetic=genetic))
    errors, tables, times = [], [], []
    for source, count in zip(sources, spread(trials, len(sources)), strict=True):
        scans = scans_of(folder, source)
        for trial in box_trials(scans, count, _FILL * genetic.linear, _FILL * genetic.angular, seed=2):
            points = near_points(trial.new, matcher.config.refinement.surfaces.range_limit)
            start = time.process_time()
            matcher.table(trial.reference)
            built = time.process_time()
            found = matcher.search(trial.reference, points, trial.guess)
            times.append(1e3 * (time.process_time() - built))
            tables.append(1e3 * (built - start))
            errors.append(between(trial.truth, found.pose))
    error = np.array(errors)
    return {
        "evaluations": population * generations * runs,
        "success": share(is_success(error, PRE_LINEAR, PRE_ANGULAR).tolist()).to_dict(),
        "error_m": t_mean(np.hypot(error[:, 0], error[:, 1]), least=0.0).to_dict(),
        "error_deg": t_mean(np.degrees(np.abs(error[:, 2])), least=0.0).to_dict(),
        "median_m": float(np.median(np.hypot(error[:, 0], error[:, 1]))),
        "median_deg": float(np.median(np.degrees(np.abs(error[:, 2])))),
        "timing": {"search_ms": quantiles(times), "table_ms": quantiles(tables)},
    }


def exact(folder: str | None, source: str, trials: int) -> dict[str, Any]:
    """Return in how many trials both searches of `global` find, to the bit, what trying every pose finds."""
    config = GlobalConfig()
    matcher, equal, equal_views = GlobalMatcher(config), 0, 0
    for trial in split_trials(scans_of(folder, source), trials, 2.12, float("nan"), seed=1):
        limit = config.refinement.surfaces.range_limit
        points = near_points(trial.new, limit)
        grid = build_lookup(near_points(trial.reference, limit), config.lookup)
        found = matcher.search(trial.reference, points, trial.guess).best
        equal += found == exhaustive_search(grid, points, trial.guess, config.window).best
        views = matcher.search_views(trial.reference, points, trial.guess).best
        equal_views += (
            views == exhaustive_search(matcher.views_table(trial.reference), points, trial.guess, config.window).best
        )
    return {"equal": equal, "equal_views": equal_views, "trials": trials}


def example(folder: str | None, source: str, scan: int, guess: Sequence[float]) -> dict[str, Any]:
    """Return one match in pieces, for Fig. 4: the points, populations, the first and the last step of MbICP.

    Args:
        folder: Of the logs; None: a simulated scan.
        source: The log.
        scan: Which scan of it.
        guess: (3,) [m, m, rad]; the truth is zero.
    """
    scans = scans_of(folder, source)
    (trial,) = split_trials([scans[scan % len(scans)]], 1, 0.0, 0.0, seed=0)
    genetic: GeneticConfig = replace(LARGE, generations=13, runs=1)
    matcher = HybridMatcher(HybridConfig(genetic=genetic, refine=False))
    points = near_points(trial.new, 30.0)
    found = matcher.search(trial.reference, points, guess)
    steps = [
        IterativeMatcher(replace(MBICP, most_iterations=most)).refine(trial.reference, points, found.pose)
        for most in (1, MBICP.most_iterations)
    ]
    return {
        "reference": near_points(trial.reference, 30.0).tolist(),
        "new": points.tolist(),
        "guess": list(guess),
        "generations": {str(g): found.populations[0, g].tolist() for g in (0, 5, 12)},
        "fitness": {str(g): found.fitnesses[0, g].tolist() for g in (0, 5, 12)},
        "first_step": steps[0].pose.tolist(),
        "last_step": steps[1].pose.tolist(),
        "iterations": steps[1].iterations,
    }
