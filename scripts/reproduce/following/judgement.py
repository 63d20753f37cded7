"""Raw against filtered, pair by pair."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...experiments.statistics import Estimate, t_mean
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


@dataclass(frozen=True)
class Pair:
    """One metric of the same drives, mapped from raw and from filtered scans.

    Attributes:
        raw: (n,) from raw scans.
        filtered: (n,) from filtered scans.
        lower_is_better: Which way is better.
    """

    raw: Array
    filtered: Array
    lower_is_better: bool

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
    return Pair(raw, filtered, metric in LOWER_IS_BETTER)


def value_of(row: Any, metric: str) -> float:
    """Return the metric of a map cell's result; NaN where it has none."""
    for key in METRICS[metric]:
        row = row.get(key) if row is not None else None
    return np.nan if row is None else float(row)
