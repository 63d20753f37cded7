"""Raw against filtered, pair by pair."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t

from ...lab.statistics import Estimate, holm, t_mean
from .plan import map_name

Array = NDArray[np.float64]

METRICS: dict[str, tuple[str, ...]] = {
    "adnn": ("adnn", "mean_m"),
    "ghosts": ("ghosts", "mean_m"),
    "truth_to_map": ("truth_to_map_m",),
    "map_to_truth": ("map_to_truth_m",),
    "ate": ("ate_rmse_m",),
    "residue": ("dynamic_residue", "cells"),
    "precision": ("cells", "precision"),
    "recall": ("cells", "recall"),
    "f1": ("cells", "f1"),
    "iou": ("cells", "iou"),
    "coverage": ("cells", "free_coverage"),
    "twin_cells": ("twin_cells",),
    "table_edges": ("table_edges_found",),
}
"""Name -> where it stands in the result of a map cell."""
LOWER_IS_BETTER = frozenset({"adnn", "ghosts", "truth_to_map", "map_to_truth", "ate", "residue", "twin_cells"})
_SHARES = frozenset({"precision", "recall", "f1", "iou", "coverage", "twin_cells", "table_edges"})
LEVEL = 0.05
"""Of several tests together, filtering surely does something where Holm's correction leaves p below this."""


@dataclass(frozen=True)
class Pair:
    """One metric of the same drives, mapped from raw and from filtered scans.

    Attributes:
        raw: (n,) from raw scans.
        filtered: (n,) from filtered scans.
        lower_is_better: Which way is better.
        most: The most that the metric can be; 0 is the least.
    """

    raw: Array
    filtered: Array
    lower_is_better: bool
    most: float = np.inf

    @property
    def means(self) -> tuple[Estimate, Estimate]:
        """Means from raw and from filtered scans, with their 95 % intervals (Student's) over the drives."""
        return t_mean(self.raw, least=0.0, most=self.most), t_mean(self.filtered, least=0.0, most=self.most)

    @property
    def gain(self) -> Estimate:
        """Mean of what filtering gains, with its 95 % interval (Student's) over the drives."""
        sign = 1.0 if self.lower_is_better else -1.0
        return t_mean(sign * (self.raw - self.filtered))

    @property
    def verdict(self) -> str:
        """ "better" or "worse" where the interval of the gain leaves zero out, else "no effect"."""
        gain = self.gain
        return "better" if gain.low > 0.0 else "worse" if gain.high < 0.0 else "no effect"

    @property
    def p(self) -> float:
        """Of the paired t test: how likely such a gain is if filtering does nothing; 1 where nothing can be said."""
        gain = (self.raw - self.filtered)[np.isfinite(self.raw - self.filtered)]
        if len(gain) < 2 or not gain.any():
            return 1.0
        with np.errstate(divide="ignore"):  # the same gain in each drive
            size = abs(gain.mean()) / (gain.std(ddof=1) / np.sqrt(len(gain)))
        return float(2.0 * t.sf(size, len(gain) - 1))

    @property
    def ratio(self) -> float:
        """Mean of raw over mean of filtered."""
        return float(np.nanmean(self.raw) / np.nanmean(self.filtered)) if np.nanmean(self.filtered) > 0.0 else np.nan


def pair(
    results: Mapping[str, Any],
    metric: str,
    scene: str,
    people: int,
    odometry: str,
    usable: float,
    variant: str,
    seeds: Sequence[int],
) -> Pair:
    """Return a metric of the same drives from raw and from filtered scans."""
    raw, filtered = (
        np.array(
            [
                value_of(results[map_name(scene, people, odometry, usable, variant, scans, seed)], metric)
                for seed in seeds
            ]
        )
        for scans in ("raw", "filtered")
    )
    return Pair(raw, filtered, metric in LOWER_IS_BETTER, 1.0 if metric in _SHARES else np.inf)


def sure_verdicts(pairs: Sequence[Pair]) -> list[str]:
    """Return the verdicts of pairs that are judged together: "no effect" where Holm's correction leaves no other."""
    corrected = holm([each.p for each in pairs])
    return [each.verdict if p < LEVEL else "no effect" for each, p in zip(pairs, corrected, strict=True)]


def value_of(row: Any, metric: str) -> float:
    """Return the metric of a map cell's result; NaN where it has none."""
    for key in METRICS[metric]:
        row = row.get(key) if row is not None else None
    return np.nan if row is None else float(row)
