"""What the worlds say together: intervals, the paired test of the paper's claim, consistency and recovery."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import binomtest, chi2, wilcoxon

from ...lab.statistics import Estimate, holm, ratio, share
from .cells import GAPS
from .drives import ROBOTS
from .methods import METHODS, PAPER

Array = NDArray[np.float64]

CLAIMED = 0.95
"""The paper: with DBSCAN the error is 5 % smaller."""
NEAR_M = 0.1
_SKIPPED = 5  # steps at the start, where nothing has happened yet


@dataclass(frozen=True, eq=False)
class Worlds:
    """The results of the world cells.

    Attributes:
        rows: One a world.
    """

    rows: Sequence[Mapping[str, Any]]

    def error(self, method: str, robot: str, kind: str, figure: str = "rms_m") -> Array:
        """Return (worlds,) a figure of `errors_of`; `kind` is "slam", "localization", "lost" or "odometry"."""
        of = [row["robots"][robot] for row in self.rows]
        return np.array([r["odometry"][figure] if kind == "odometry" else r[method][kind][figure] for r in of])

    def cluster_ms(self, method: str) -> Array:
        """Return (worlds,) the mean time of clustering a scan [ms]."""
        return np.array([1e3 * row["timing"][method]["cluster_s"] / row["keys"] for row in self.rows])

    def total_s(self, method: str) -> Array:
        """Return (worlds,) the time of a whole drive: clustering, associating, updating [s]."""
        of = [row["timing"][method] for row in self.rows]
        return np.array([t["cluster_s"] + t["typical_filter_s"] for t in of])


@dataclass(frozen=True)
class Compared:
    """DBSCAN against another method over the same worlds.

    Attributes:
        other: The other method.
        ratio: DBSCAN's mean over the other's, with its 95 % interval over worlds (Fieller).
        equal: Worlds in which both are equal.
        p: Wilcoxon's signed ranks, after Holm's correction.
    """

    other: str
    ratio: Estimate
    equal: int
    p: float

    @property
    def verdict(self) -> str:
        """What the test says of DBSCAN."""
        if self.p >= 0.05:
            return "no difference found"
        return "DBSCAN less" if self.ratio.mean < 1.0 else "DBSCAN more"


def compare_all(values: Mapping[str, Array]) -> list[Compared]:
    """Return DBSCAN against each other method of `values` (worlds,)."""
    others = [name for name in values if name != "dbscan"]
    raw = [_signed_ranks(values["dbscan"], values[name]) for name in others]
    adjusted = holm(raw)
    return [
        Compared(
            name, ratio(values["dbscan"], values[name]), int((values["dbscan"] == values[name]).sum()), adjusted[k]
        )
        for k, name in enumerate(others)
    ]


def claim(worlds: Worlds) -> dict[str, Any]:
    """Return whether DBSCAN is the fastest of the paper's four, and 5 % better than each."""
    fast = compare_all({name: worlds.total_s(name) for name in PAPER})
    right = compare_all({name: worlds.error(name, "typical", "slam") for name in PAPER})
    return {
        "timing": {"fastest": all(found.p < 0.05 and found.ratio.high < 1.0 for found in fast)},
        "five_percent_better": all(found.ratio.high <= CLAIMED for found in right),
        "more_accurate_than": [found.other for found in right if found.p < 0.05 and found.ratio.mean < 1.0],
    }


def slowest(worlds: Worlds) -> str:
    """Return the slowest of the paper's four methods."""
    return max(PAPER, key=lambda name: float(worlds.total_s(name).mean()))


@dataclass(frozen=True, eq=False)
class Consistency:
    """Average NEES of the pose.

    Attributes:
        average: (steps,) over the worlds.
        low: Lower 95 % bound of a consistent filter's.
        high: Upper one.
        inside: Share of the steps within.
    """

    average: Array
    low: float
    high: float
    inside: float


def consistency(rows: Sequence[Mapping[str, Any]]) -> Consistency:
    """Return the average NEES over the worlds, step by step, and how often it lies within chi-square's bounds."""
    steps = min(len(row["nees"]) for row in rows)
    average = np.mean([row["nees"][:steps] for row in rows], axis=0)
    low, high = (chi2.ppf([0.025, 0.975], 3 * len(rows)) / len(rows)).tolist()
    judged = average[_SKIPPED:]
    return Consistency(average, low, high, float(((judged > low) & (judged < high)).mean()))


def recovery(rows: Sequence[Mapping[str, Any]]) -> dict[str, dict[str, Any]]:
    """Return, by kind of gap, the share of worlds whose error was below 10 cm 3 m after landmarks were seen again."""
    found = {}
    for name in GAPS:
        seen = [row[name] for row in rows if row[name]["seen_again"]]
        back = [world["within_3_m"] < NEAR_M for world in seen]
        far = [world["within_3_m"] < NEAR_M for world in seen if world["peak_m"] > NEAR_M]
        test = binomtest(sum(back), len(back), 0.95, alternative="greater") if back else None
        found[name] = {
            "worlds": len(seen),
            "not_seen_again": len(rows) - len(seen),
            "back": share(back),
            "of_those_beyond": share(far),
            "p_more_than_95": float(test.pvalue) if test else None,
            "peak_m": float(np.mean([world["peak_m"] for world in seen])) if seen else None,
            "after_m": float(np.median([world["within_3_m"] for world in seen])) if seen else None,
            "stayed": share([world["worst_later_m"] < NEAR_M for world in seen]),
            "lost_before": sum(world["before_m"] >= NEAR_M for world in seen),
        }
    return found


def numbers(worlds: Worlds) -> dict[str, Any]:
    """Return the figures of all methods, for results.json."""
    figures: dict[str, Any] = {}
    for name in METHODS:
        errors = {robot: _summary(worlds.error(name, robot, "slam")) for robot in ROBOTS}
        times = {"cluster_ms": _summary(worlds.cluster_ms(name)), "total_s": _summary(worlds.total_s(name))}
        figures[name] = {"rms_m": errors, "timing": times}
    return figures


def _summary(values: Array) -> dict[str, float]:
    return {"mean": float(values.mean()), "median": float(np.median(values))}


def _signed_ranks(a: Array, b: Array) -> float:
    if np.array_equal(a, b):
        return 1.0
    return float(wilcoxon(a, b)[1])  # pyright: ignore[reportArgumentType]
