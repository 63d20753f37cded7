"""How much of the floor was seen, and how soon."""

import numpy as np

from .history import History

SHARES = (0.90, 0.95, 0.99)
"""Shares of the floor whose times are reported."""


def exploration_metrics(history: History) -> dict[str, float]:
    """Return the figures of coverage; see `tagalong.envs.task.coverage` for what counts as seen.

    - `coverage`: share of the floor seen in the end.
    - `time_to_90_s`, `time_to_95_s`, `time_to_99_s`: time until that share was seen; NaN where it never was.
    """
    elapsed = history.time_s - history.time_s[0]
    times = {}
    for share in SHARES:
        reached = history.coverage >= share
        times[f"time_to_{100 * share:.0f}_s"] = float(elapsed[np.argmax(reached)]) if reached.any() else float("nan")
    return {"coverage": float(history.coverage[-1]), **times}
