"""Who matches: the paper's matchers, the same with a polish, and ours; and where the scans come from."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ....slam.scan import LaserScan
from ....slam.scan_to_scan import Matcher, make_matcher
from ....slam.scan_to_scan.iterative import MBICP, IterativeMatcher
from ...lab.scan_pairs import LOGS, read_scans, simulated_scans

SIMULATED = "simulated"
MAIN = ("intel", "belgioioso", "sena", "seattle")
"""Logs of the main experiments."""
SUFFIX = "+plicp"
PLAIN = "mbicp-plain"
FAMILY = ("hglasm-g-large", "hglasm-g-medium", "hglasm-g-small")

# What the robust weight and the shrinking reach do is left out: nearest points within 1 m, the nearest 95 % of them.
_PLAIN = replace(MBICP, first_reach=1.0, last_reach=1.0, first_scale=1e3, last_scale=1e3, most_iterations=100)


def make_contestant(name: str) -> Matcher:
    """Return a new matcher.

    Args:
        name: As `make_matcher` has it; with "+plicp" after a hybrid one's a point-to-line polish follows; "mbicp-plain"
            is MbICP without robust weights.
    """
    if name == PLAIN:
        return IterativeMatcher(_PLAIN)
    if name.endswith(SUFFIX):
        return make_matcher(name.removesuffix(SUFFIX), polish=True)
    return make_matcher(name)


def scans_of(folder: str | None, source: str) -> Sequence[LaserScan]:
    """Return the scans of a log in `folder`, or the simulated ones."""
    return simulated_scans() if folder is None or source == SIMULATED else read_scans(Path(folder), source)


def logs_in(folder: Path | None, names: Sequence[str] = tuple(LOGS)) -> tuple[str, ...]:
    """Return which of the logs are in `folder`."""
    return tuple(name for name in names if folder is not None and (folder / LOGS[name]).is_file())


def spread(total: int, parts: int) -> list[int]:
    """Return `total` split into `parts` numbers as equal as can be."""
    return [total // parts + (k < total % parts) for k in range(parts)]


def quantiles(values: Sequence[float] | NDArray[np.float64]) -> dict[str, float | None]:
    """Return mean, standard deviation, median and 95 % quantile; None where there are no values."""
    sample = np.asarray(values, dtype=np.float64)
    if len(sample) == 0:
        return {"mean": None, "sd": None, "median": None, "p95": None}
    return {
        "mean": float(sample.mean()),
        "sd": float(sample.std()),
        "median": float(np.median(sample)),
        "p95": float(np.quantile(sample, 0.95)),
    }
