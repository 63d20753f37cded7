"""Cells of the paper's protocol: odd readings against even ones, from a guess that is off by a known error."""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....slam.geometry import between
from ....slam.scan_to_scan import Match, Matcher
from ....slam.scan_to_scan.hybrid import HybridMatcher
from ...lab.scan_pairs import Trial, blind_direction, is_success, split_trials
from ...lab.statistics import quantile_interval, share, t_mean
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
    angle = float("nan") if rotation is None else float(np.radians(rotation))
    answers: list[Answer] = []
    by_source = {}
    for source, count in zip(sources, spread(trials, len(sources)), strict=True):
        scans = scans_of(folder, source)
        asked = split_trials(scans, count, translation, angle, seed, noise=noise, people=people)
        given = [timed_match(tool, trial) for trial in asked]
        by_source[source] = share([answer.good for answer in given]).to_dict()
        answers += given
    return {"by_source": by_source, **_summary(answers)}


@dataclass(frozen=True, eq=False)
class Answer:
    """A match, and what it took.

    Attributes:
        match: The match.
        error: (3,) of its pose.
        searched: (3,) error of the search before the refinement; None where there is none.
        table_ms: Process time of the lookup table, 0 where there is none.
        match_ms: Process time of all the rest.
    """

    match: Match
    error: NDArray[np.float64]
    searched: NDArray[np.float64] | None
    table_ms: float
    match_ms: float

    @property
    def good(self) -> bool:
        """Whether the pose is in the paper's ellipsoid."""
        return bool(is_success(self.error))


def _summary(answers: Sequence[Answer]) -> dict[str, Any]:
    good = [answer.good for answer in answers]
    iterations = np.array([answer.match.iterations for answer in answers])
    searched = [answer.searched for answer in answers if answer.searched is not None]
    before = is_success(np.array(searched), PRE_LINEAR, PRE_ANGULAR).tolist() if searched else None
    return {
        "success": share(good).to_dict(),
        "prealigned": share(before).to_dict() if before is not None else None,
        **converged_errors(np.array([answer.error for answer in answers])[good]),
        "iterations": t_mean(iterations, least=0.0).to_dict(),
        "believed": share([answer.match.converged for answer in answers]).to_dict(),
        "right_of_believed": share([answer.good for answer in answers if answer.match.converged]).to_dict(),
        "timing": {
            "table_ms": quantiles([answer.table_ms for answer in answers]),
            "total_ms": quantiles([answer.table_ms + answer.match_ms for answer in answers]),
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


def timed_match(tool: Matcher, trial: Trial) -> Answer:
    """Return the answer to a trial, with times."""
    start = time.process_time()
    if isinstance(tool, HybridMatcher):
        tool.table(trial.reference)
    middle = time.process_time()
    match = tool.match(trial.reference, trial.new, trial.guess)
    end = time.process_time()
    searched = None if match.searched is None else between(trial.truth, match.searched)
    error = between(trial.truth, match.pose)
    return Answer(match, error, searched, 1e3 * (middle - start), 1e3 * (end - middle))


def converged_errors(errors: NDArray[np.float64]) -> dict[str, Any]:
    """Return statistics of the errors (n, 3) of the trials that converged."""
    millimetres, degrees = np.hypot(errors[:, 0], errors[:, 1]) * 1e3, np.degrees(np.abs(errors[:, 2]))
    return {
        name: {**quantiles(values), "p95_interval": list(quantile_interval(values, 0.95)) if len(values) else None}
        for name, values in (("error_mm", millimetres), ("error_deg", degrees))
    }
