"""The time of one stage, of many calls."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

WARM_UP = 20
"""Calls before timing starts: compiled kernels are loaded, caches filled."""


@dataclass(frozen=True)
class Latency:
    """Time of one stage.

    Attributes:
        mean_ms: Mean [ms].
        p95_ms: Ninety-five of a hundred calls take at most this long [ms].
        calls: How many calls were timed.
    """

    mean_ms: float
    p95_ms: float
    calls: int


def latency(times_s: Sequence[float]) -> Latency:
    """Return mean and 95 % point of `times_s` [s]."""
    milliseconds = 1e3 * np.asarray(times_s)
    return Latency(float(milliseconds.mean()), float(np.percentile(milliseconds, 95)), len(milliseconds))
