"""Cells of the paper's protocol: odd readings against even ones, from a guess that is off by a known error."""

import time
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....slam.geometry import between
from ....slam.matching import Match, Matcher
from ....slam.matching.hybrid import HybridMatcher
from ...experiments.scan_pairs import Trial, blind_direction, is_success, split_trials
from ...experiments.statistics import bootstrap_mean, share
from .contestants import make_contestant, quantiles, scans_of, spread

PRE_LINEAR, PRE_ANGULAR = 0.30, 0.1
"""Half axes of the ellipsoid of a successful pre-alignment [m, rad]."""


def success(
    folder: str | None,
    sources: Sequence[str],
    matcher: str,
    translation: float,
    rotation: float | None,
    trials: int,
    noise: float = 0.0,
    people: int = 0,
    seed: int = 0,
) -> dict[str, Any]:
    """Return how often a matcher succeeds at one error of the guess, how exactly, after how many iterations.

    Args:
        folder: Of the logs; None: simulated scans.
        sources: The logs; each gives an equal share of the trials.
        matcher: Its name, see `make_contestant`.
        translation: Error of the guess [m].
        rotation: Error of the guess [deg]; None: any, evenly drawn.
        trials: How many.
        noise: Added to every range [m].
        people: Who walk before the laser.
        seed: Of the trials; equal for all matchers, so that they answer the same questions.
    """
    tool = make_contestant(matcher)
    angle = np.nan if rotation is None else np.radians(rotation)
    errors, searched, matches, times, by_source = [], [], [], [], {}
    for source, count in zip(sources, spread(trials, len(sources)), strict=True):
        first = len(errors)
        asked = split_trials(
            scans_of(folder, source), count, translation, float(angle), seed, noise=noise, people=people
        )
        for trial in asked:
            match, spent = timed_match(tool, trial)
            errors.append(between(trial.truth, match.pose))
            matches.append(match)
            times.append(spent)
            if match.searched is not None:
                searched.append(between(trial.truth, match.searched))
        by_source[source] = share(is_success(np.array(errors[first:])).tolist()).to_dict()
    good = is_success(np.array(errors))
    iterations = np.array([match.iterations for match in matches])
    return {
        "success": share(good.tolist()).to_dict(),
        "by_source": by_source,
        "prealigned": _prealigned(searched),
        **converged_errors(np.array(errors)[good]),
        "iterations": bootstrap_mean(iterations).to_dict(),
        "iterations_of_successes": bootstrap_mean(iterations[good]).to_dict(),
        "believed": share([match.converged for match in matches]).to_dict(),
        "right_of_believed": share([bool(g) for g, m in zip(good, matches, strict=True) if m.converged]).to_dict(),
        "timing": {
            "table_ms": quantiles([spent[0] for spent in times]),
            "total_ms": quantiles([sum(spent) for spent in times]),
        },
    }


def corridor(
    folder: str, sources: Sequence[str], matcher: str, translation: float, rotation: float | None, trials: int
) -> dict[str, Any]:
    """Return the success across and along corridors, apart (see `success`).

    Across: the distance from the axis is right to 0.10 m and the heading to 0.01 rad, either way round, since a
    corridor looks the same from behind. Along: the place on the axis is right to 0.10 m.
    """
    tool = make_contestant(matcher)
    scans = [(s, blind_direction(s)) for source in sources for s in scans_of(folder, source)]
    axes = {id(scan): axis for scan, axis in scans if axis is not None}
    halls = [scan for scan, axis in scans if axis is not None]
    rng = np.random.default_rng(0)
    picks = [halls[k] for k in rng.integers(len(halls), size=trials)]
    angle = np.nan if rotation is None else np.radians(rotation)
    across, along, turns = [], [], []
    for k, scan in enumerate(picks):
        (trial,) = split_trials([scan], 1, translation, float(angle), seed=k)
        error = tool.match(trial.reference, trial.new, trial.guess).pose
        axis = axes[id(scan)]
        assert axis is not None
        along.append(abs(float(axis @ error[:2])))
        across.append(abs(float(axis[0] * error[1] - axis[1] * error[0])))
        turns.append(abs((float(error[2]) + np.pi / 2) % np.pi - np.pi / 2))
    on_axis = (np.array(across) <= 0.10) & (np.array(turns) <= 0.01)
    return {
        "scans": len(halls),
        "across": share(on_axis.tolist()).to_dict(),
        "along": share((np.array(along) <= 0.10).tolist()).to_dict(),
        "across_mm": quantiles(np.array(across) * 1e3),
        "along_mm": quantiles(np.array(along) * 1e3),
    }


def timed_match(tool: Matcher, trial: Trial) -> tuple[Match, tuple[float, float]]:
    """Return the match and the times [ms] of the lookup table (0 where there is none) and of all the rest."""
    start = time.process_time()
    if isinstance(tool, HybridMatcher):
        tool.table(trial.reference)
    middle = time.process_time()
    match = tool.match(trial.reference, trial.new, trial.guess)
    return match, (1e3 * (middle - start), 1e3 * (time.process_time() - middle))


def converged_errors(errors: NDArray[np.float64]) -> dict[str, Any]:
    """Return statistics of the errors (n, 3) of the trials that converged."""
    return {
        "error_mm": quantiles(np.hypot(errors[:, 0], errors[:, 1]) * 1e3),
        "error_deg": quantiles(np.degrees(np.abs(errors[:, 2]))),
    }


def _prealigned(errors: list[NDArray[np.float64]]) -> dict[str, float] | None:
    if not errors:
        return None
    return share(is_success(np.array(errors), PRE_LINEAR, PRE_ANGULAR).tolist()).to_dict()
