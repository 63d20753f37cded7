"""Recall of legs against false legs, as a picture."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from ..figures.plots import logarithmic, new_figure, save_figure
from .evaluate_legs import LegScores


def save_leg_curve(path: Path, curves: Mapping[str, LegScores]) -> None:
    """Draw recall over false legs a scan (logarithmic) of each of `curves` into `path` (.png).

    Raises:
        MissingExtraError: If matplotlib is not installed.
    """
    figure = new_figure(7, 5)
    axes = figure.add_subplot()
    rates = np.geomspace(0.05, 10.0, 100)
    for name, scores in curves.items():
        (line,) = axes.plot(rates, [scores.recall(rate) for rate in rates], label=f"{name} ({len(scores.legs)} legs)")
        recall, false = scores.at(0.3)
        axes.plot(max(false, rates[0]), recall, "o", color=line.get_color())
    axes.set(
        xlim=(rates[0], rates[-1]),
        ylim=(0.0, 1.0),
        xlabel="false legs a scan (dots: confidence 0.3)",
        ylabel="share of labelled legs found",
    )
    logarithmic(axes, "x")
    axes.grid(alpha=0.3, which="both")
    axes.legend(loc="lower right")
    save_figure(path, figure)
