"""From measurements to plus signs, and from plus signs to a verdict on the paper's table."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from scipy.stats import rankdata, wilcoxon

from ...lab.statistics import holm, ratio

Array = NDArray[np.float64]

METHODS = {"pid": "people following", "joystick": "joystick control", "random": "random exploration"}
"""The guides that the paper compares, by our names."""
PAPER = {
    "convenience": {"pid": 2, "joystick": 1, "random": 3},
    "time saving": {"pid": 3, "joystick": 3, "random": 1},
    "motion smoothness": {"pid": 3, "joystick": 1, "random": 2},
    "safety": {"pid": 3, "joystick": 2, "random": 1},
}
"""Ye et al. 2021, Table I: number of plus signs."""
LEVEL = 0.05
"""Two guides differ where Holm's correction over the three pairs leaves p below this."""
EQUAL = (0.8, 1.25)
"""Two guides are equal where the 95 % interval of the ratio of their means lies within this."""


@dataclass(frozen=True)
class Comparison:
    """Two guides on the same buildings; lower is better.

    Attributes:
        better: The one that is significantly better; "" for neither.
        p: Of Wilcoxon's signed rank test, after Holm's correction.
        equal: Whether they are equal to within `EQUAL`.
        low: Lower end of the 95 % interval of the ratio of the means, first to second.
        high: Its upper end.
    """

    better: str
    p: float
    equal: bool
    low: float
    high: float


Comparisons = Mapping[tuple[str, str], Comparison]


def compare(values: Mapping[str, Array]) -> Comparisons:
    """Return the comparison of each pair of guides; `values` are (n,) of each, the same buildings in the same order.

    Buildings where either has no value are left out of the pair. Both orders of a pair are there.
    """
    pairs = list(combinations(values, 2))
    corrected = holm([_p_value(values[a], values[b]) for a, b in pairs])
    comparisons = {}
    for (a, b), p in zip(pairs, corrected, strict=True):
        both = np.isfinite(values[a]) & np.isfinite(values[b])
        x, y = values[a][both], values[b][both]
        low, high = _ratio_interval(x, y)
        wins = "" if p >= LEVEL else a if _shift(x, y) < 0.0 else b
        comparisons[a, b] = Comparison(wins, p, EQUAL[0] <= low and high <= EQUAL[1], low, high)
        comparisons[b, a] = Comparison(wins, p, comparisons[a, b].equal, _inverse(high), _inverse(low))
    return comparisons


def pluses(guides: Sequence[str], comparisons: Comparisons) -> dict[str, int]:
    """Return the plus signs: one, and one more for each guide that it is significantly better than."""
    return {a: 1 + sum(comparisons[a, b].better == a for b in guides if b != a) for a in guides}


def verdict(criterion: str, guide: str, comparisons: Comparisons) -> str:
    """Return "confirmed", "refuted" or "not separable" for one cell of the paper's table.

    A cell claims how its guide stands to the two others. More signs: it is significantly better. Equal signs: it is
    equal. Confirmed if both claims hold, refuted if one is contradicted: the other one is significantly better, or of
    equal signs one is better and they are not equal. Not separable otherwise.
    """
    signs, states = PAPER[criterion], []
    for other in METHODS:
        if other == guide:
            continue
        claim, found = np.sign(signs[guide] - signs[other]), comparisons[guide, other]
        ours = 0 if not found.better else 1 if found.better == guide else -1
        if claim == 0:
            states.append("holds" if found.equal else "contradicted" if ours else "open")
        else:
            states.append("holds" if ours == claim else "contradicted" if ours == -claim else "open")
    if "contradicted" in states:
        return "refuted"
    return "confirmed" if states == ["holds", "holds"] else "not separable"


def _p_value(x: Array, y: Array) -> float:
    both = np.isfinite(x) & np.isfinite(y)
    difference = x[both] - y[both]
    if not np.any(difference):
        return 1.0
    _, p = wilcoxon(difference, zero_method="pratt")
    return float(np.asarray(p))


def _shift(x: Array, y: Array) -> float:
    """Return the sign that the signed ranks of x - y lean to; equal differences share their ranks, as in the test."""
    difference = x - y
    return float(np.sum(np.sign(difference) * rankdata(np.abs(difference))))


def _ratio_interval(x: Array, y: Array) -> tuple[float, float]:
    """Return the 95 % interval of mean(x) / mean(y) over pairs (Fieller); (0, inf) where it cannot be said."""
    found = ratio(x, y)
    return (0.0, float("inf")) if np.isnan(found.low) else (found.low, found.high)


def _inverse(value: float) -> float:
    return 1.0 / value if value > 0.0 else float("inf")
