"""Statistics of a column as LeRobot's policies use them to normalize: of an episode, and of all of them together."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .lerobot_features import Frames

Statistics = dict[str, dict[str, NDArray[np.float64]]]
"""Column -> figure -> an array of the column's shape; `count` has one number."""

_QUANTILES = {"q01": 0.01, "q10": 0.10, "q50": 0.50, "q90": 0.90, "q99": 0.99}


def episode_statistics(frames: Frames) -> Statistics:
    """Return least, greatest, mean, spread and quantiles of each column over the frames of an episode."""
    return {name: _column(array.astype(np.float64).reshape(len(array), *(array.shape[1:] or (1,)))) for name, array in
            frames.items()}  # fmt: skip


def _column(array: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
    quantiles = np.quantile(array, list(_QUANTILES.values()), axis=0)
    return {
        "min": array.min(axis=0),
        "max": array.max(axis=0),
        "mean": array.mean(axis=0),
        "std": array.std(axis=0),
        "count": np.array([len(array)], dtype=np.float64),
        **dict(zip(_QUANTILES, quantiles, strict=True)),
    }


def all_statistics(episodes: Sequence[Statistics]) -> Statistics:
    """Return the statistics of all episodes; their quantiles are means of quantiles, as LeRobot has it."""
    return {name: _together([one[name] for one in episodes]) for name in episodes[0]}


def _together(parts: list[dict[str, NDArray[np.float64]]]) -> dict[str, NDArray[np.float64]]:
    weights = np.array([part["count"][0] for part in parts], dtype=np.float64)

    def mean(values: list[NDArray[np.float64]]) -> NDArray[np.float64]:
        return np.average(np.stack(values), axis=0, weights=weights)

    centre = mean([part["mean"] for part in parts])
    variance = mean([part["std"] ** 2 + (part["mean"] - centre) ** 2 for part in parts])
    return {
        "min": np.min([part["min"] for part in parts], axis=0),
        "max": np.max([part["max"] for part in parts], axis=0),
        "mean": centre,
        "std": np.sqrt(variance),
        "count": np.array([weights.sum()]),
        **{name: mean([part[name] for part in parts]) for name in _QUANTILES},
    }
