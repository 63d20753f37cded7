"""Intervals of what experiments measure."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.stats import beta, binom, binomtest, t, wilcoxon

from ...slam.errors import InputError


@dataclass(frozen=True)
class Estimate:
    """A mean with its 95 % interval.

    Attributes:
        mean: The mean, or the share of successes.
        low: Lower end of the interval.
        high: Upper end of the interval.
        n: How many values it was made of.
    """

    mean: float
    low: float
    high: float
    n: int

    def to_dict(self) -> dict[str, float]:
        """Return it as a plain dict."""
        return {"mean": self.mean, "low": self.low, "high": self.high, "n": self.n}

    def text(self, scale: float = 1.0, digits: int = 2) -> str:
        """Return "mean [low, high]", each times `scale`; the mean alone without an interval, "-" of no values."""
        if np.isnan(self.mean):
            return "-"
        mean, low, high = (f"{value * scale:.{digits}f}" for value in (self.mean, self.low, self.high))
        return mean if np.isnan(self.low) else f"{mean} [{low}, {high}]"


def t_mean(values: ArrayLike, *, least: float = -np.inf, most: float = np.inf) -> Estimate:
    """Return the mean of `values` (n,) with Student's interval, honest for few values; NaN are left out.

    With one value the ends of the interval are NaN: nothing says how far it is from the mean. (A percentile bootstrap
    of five normal values holds their mean in 85 % of all cases, not in 95 %.)

    Args:
        values: (n,) independent of each other.
        least: The mean cannot be less: the interval is cut there.
        most: Nor can it be more.
    """
    sample = np.asarray(values, dtype=np.float64)
    sample = sample[np.isfinite(sample)]
    if len(sample) < 2:
        return Estimate(float(sample.mean()) if len(sample) else np.nan, np.nan, np.nan, len(sample))
    mean, half = float(sample.mean()), float(t.ppf(0.975, len(sample) - 1) * sample.std(ddof=1) / np.sqrt(len(sample)))
    return Estimate(mean, max(mean - half, least), min(mean + half, most), len(sample))


def metric_mean(metric: str, values: ArrayLike) -> Estimate:
    """Return `t_mean` of a figure of episodes or maps, its interval cut to what a figure of that name can be."""
    if metric in _SIGNED or metric.startswith("min_distance"):
        return t_mean(values)
    return t_mean(values, least=0.0, most=1.0 if metric.endswith(_SHARES) else np.inf)


_SIGNED = ("sparc", "ldlj", "total_reward")
_SHARES = ("share", "compliance", "coverage", "success")


def holm(p_values: Sequence[float]) -> list[float]:
    """Return the p-values of tests that are judged together, corrected for how many they are (Holm 1979)."""
    adjusted, running = [0.0] * len(p_values), 0.0
    for rank, k in enumerate(np.argsort(p_values, kind="stable").tolist()):
        running = max(running, min(1.0, (len(p_values) - rank) * p_values[k]))
        adjusted[k] = running
    return adjusted


def quantile_interval(values: ArrayLike, quantile: float) -> tuple[float, float]:
    """Return the 95 % interval of a quantile of what `values` (n,) are drawn from, by order statistics."""
    sample = np.sort(np.asarray(values, dtype=np.float64))
    if len(sample) == 0:
        return np.nan, np.nan
    low, high = (int(binom.ppf(level, len(sample), quantile)) for level in (0.025, 0.975))
    return float(sample[max(low - 1, 0)]), float(sample[min(high, len(sample) - 1)])


def share(successes: Sequence[bool]) -> Estimate:
    """Return the share of true values with its Wilson interval."""
    count = len(successes)
    if count == 0:
        return Estimate(np.nan, np.nan, np.nan, 0)
    interval = binomtest(int(sum(successes)), count).proportion_ci(method="wilson")
    return Estimate(sum(successes) / count, float(interval.low), float(interval.high), count)


def upper_bound(part: int, whole: int) -> float:
    """Return the largest share that `part` of `whole` leave believable, one-sided at 95 % (Clopper and Pearson 1934).

    None of n: 1 - 0.05^(1/n), about 3 / n.

    Raises:
        InputError: If there is no whole, or the part is none of it.
    """
    if not 0 <= part <= whole or whole == 0:
        raise InputError(f"a share needs a part of at least one, got {part} of {whole}")
    return 1.0 if part == whole else float(beta.ppf(0.95, part + 1, whole - part))


def ratio(above: ArrayLike, below: ArrayLike) -> Estimate:
    """Return the ratio of the sums of `above` (n,) and `below` (n,), which belong together pair by pair.

    Its interval holds the ratios r with which the mean of above - r below is not surely other than 0 by Student's t
    (Fieller 1954). Where the sum below is not surely other than 0, it ends at infinity. With one pair its ends are
    NaN; so is everything where the sum below is 0.
    """
    a, b = np.asarray(above, dtype=np.float64), np.asarray(below, dtype=np.float64)
    n = len(a)
    if n == 0 or b.sum() == 0.0:
        return Estimate(np.nan, np.nan, np.nan, n)
    middle = float(a.sum() / b.sum())
    if n < 2:
        return Estimate(middle, np.nan, np.nan, n)
    spread = float(t.ppf(0.975, n - 1)) ** 2 * np.cov(a, b) / n
    square, product, rest = (
        b.mean() ** 2 - spread[1, 1],
        a.mean() * b.mean() - spread[0, 1],
        a.mean() ** 2 - spread[0, 0],
    )
    within = product**2 - square * rest  # of square r^2 - 2 product r + rest <= 0
    if square > 0.0:
        half = np.sqrt(max(within, 0.0))
        return Estimate(middle, max(float((product - half) / square), 0.0), float((product + half) / square), n)
    least = float((product - np.sqrt(within)) / square) if within > 0.0 > square else 0.0
    return Estimate(middle, least if 0.0 < least <= middle else 0.0, np.inf, n)


@dataclass(frozen=True)
class Paired:
    """Two answers to each of the same questions, compared.

    Attributes:
        only_first: To how many the first alone is right.
        only_second: To how many the second alone is.
        difference: Share of right answers, the second's less the first's.
        low: Lower end of its 95 % interval.
        high: Upper end of that.
        p: Of McNemar's exact test: how likely such a difference is if both are equally good.
        n: How many questions.
    """

    only_first: int
    only_second: int
    difference: float
    low: float
    high: float
    p: float
    n: int


def paired_shares(first: Sequence[bool], second: Sequence[bool]) -> Paired:
    """Return how two sequences of answers to the same questions compare (McNemar 1947; Wald's interval).

    Raises:
        InputError: If they are not equally long, or empty.
    """
    a, b = np.asarray(first, dtype=bool), np.asarray(second, dtype=bool)
    if a.shape != b.shape or len(a) == 0:
        raise InputError(f"need as many answers of both, at least one, got {a.shape} and {b.shape}")
    lost, won, n = int((a & ~b).sum()), int((~a & b).sum()), len(a)
    difference = (won - lost) / n
    half = 1.96 * np.sqrt(max((won + lost) / n - difference**2, 0.0) / n)
    p = float(binomtest(won, won + lost).pvalue) if won + lost else 1.0
    return Paired(lost, won, difference, difference - half, difference + half, p, n)


@dataclass(frozen=True)
class PairedValues:
    """A figure of the same episodes of two, compared.

    Attributes:
        median_difference: Median of the second's less the first's; NaN without any pair.
        p: Of Wilcoxon's signed ranks: how likely such differences are if both are equally good.
        n: How many pairs.
    """

    median_difference: float
    p: float
    n: int


def paired_values(first: ArrayLike, second: ArrayLike) -> PairedValues:
    """Return how two figures (n,) of the same things compare; pairs with NaN are left out."""
    apart = np.asarray(second, dtype=np.float64) - np.asarray(first, dtype=np.float64)
    apart = apart[np.isfinite(apart)]
    moved = apart[apart != 0.0]
    p = float(tuple(wilcoxon(moved))[1]) if len(moved) else 1.0
    return PairedValues(float(np.median(apart)) if len(apart) else np.nan, p, len(apart))
