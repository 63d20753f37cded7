"""The results of the cells, found by what was asked."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...lab.statistics import Estimate
from .plan import POINTS, MatchingPlan, search_name, success_name
from .searches import ALGORITHMS


@dataclass(frozen=True)
class Answers:
    """What the cells of a plan returned.

    Attributes:
        results: By cell name.
        plan: The plan.
    """

    results: Mapping[str, Any]
    plan: MatchingPlan

    def on_grid(self, matcher: str, at: tuple[float, float | None]) -> dict[str, Any]:
        """Return the result of a matcher at an error of the guess (m, deg) of Figs. 7 and 8."""
        return self.results[success_name(matcher, at, self.plan.extent.trials, simulated=self.is_simulated)]

    def at_point(self, matcher: str, at: tuple[float, float | None], simulated: bool = False) -> dict[str, Any]:
        """Return the result of a matcher at one of the paper's two points, where there are more trials."""
        simulated = simulated or self.is_simulated
        return self.results[success_name(matcher, at, self.plan.extent.point_trials, simulated=simulated)]

    def disturbed(self, matcher: str, noise: float = 0.0, people: int = 0) -> dict[str, Any]:
        """Return the result of a matcher at 0.57 m / 20 deg, with noise [m] or people added."""
        more: dict[str, Any] = {"noise": noise} if noise else {"people": people} if people else {}
        return self.results[
            success_name(matcher, POINTS[0], self.plan.extent.trials, simulated=self.is_simulated, **more)
        ]

    def searches(self, algorithm: str, space: str) -> list[dict[str, Any]]:
        """Return the results of a genetic search, from few to many evaluations."""
        pairs = self.plan.configurations[space]
        return [self.results[search_name(algorithm, space, *pair)] for pair in pairs]

    def needed(self, space: str, level: float, timed: bool = False) -> dict[str, float]:
        """Return by algorithm what success at `level` takes: evaluations or, `timed`, milliseconds; inf: never."""
        needed = {}
        for algorithm in ALGORITHMS:
            found = self.searches(algorithm, space)
            cost = [r["timing"]["search_ms"]["median"] if timed else r["evaluations"] for r in found]
            needed[algorithm] = crossing(np.array(cost), np.array([r["success"]["mean"] for r in found]), level)
        return needed

    @property
    def is_simulated(self) -> bool:
        """Whether there are no logs."""
        return self.plan.sources == ("simulated",)


def estimate(result: Mapping[str, float]) -> Estimate:
    """Return an estimate that was stored as a dict."""
    nan = float("nan")
    mean, low, high = (nan if result[key] is None else result[key] for key in ("mean", "low", "high"))
    return Estimate(mean, low, high, int(result["n"]))


def percent(result: Mapping[str, float]) -> str:
    """Return "93.0 [91.2, 94.5]" of a stored share."""
    return estimate(result).text(100.0, 1)


def crossing(cost: NDArray[np.float64], success: NDArray[np.float64], level: float) -> float:
    """Return the cost at which `success` (n,) first reaches `level`; between points, its logarithm is linear."""
    reached = np.flatnonzero(success >= level)
    if len(reached) == 0:
        return float("inf")
    k = int(reached[0])
    if k == 0:
        return float(cost[0])
    part = (level - success[k - 1]) / (success[k] - success[k - 1])
    return float(np.exp(np.log(cost[k - 1]) + part * (np.log(cost[k]) - np.log(cost[k - 1]))))
