"""Figures 5 to 8 of the paper, and ours beside them."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ....slam.scan_to_scan.genetic import SIZES
from ...figures.plots import logarithmic, new_figure, save_figure
from ..report import Figure
from .answers import Answers, estimate
from .contestants import PLAIN
from .plan import (
    AXIS_MATCHERS,
    DISTANCES,
    NOISES,
    PAIR_MATCHERS,
    PATH,
    PEOPLE,
    TURNS,
    VIEW_MATCHERS,
    distance_name,
    view_name,
)
from .searches import ALGORITHMS

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_COLOURS = {"pga": "#969ba3", "glasm": "#1f57d6", "glasm-g": "#d62728"}
_PANELS = (
    ("hglasm-g-large", "HGLASM-g large (Fig. 7 left)"),
    ("hglasm-g-medium", "HGLASM-g medium (Fig. 7 right)"),
    ("hglasm-g-small", "HGLASM-g small (Fig. 8 left)"),
    (PLAIN, "MbICP without robust weights (Fig. 8 right)"),
    ("mbicp", "MbICP as we have it (Fig. 8 right)"),
    ("global", "ours: global"),
)


def draw_errors(answers: Answers, folder: Path) -> Figure:
    """Draw Fig. 5: errors over evaluations."""
    figure = new_figure(11.0, 7.4)
    for row, space in enumerate(answers.plan.configurations):
        for column, (mean, median, label) in enumerate(
            (("error_m", "median_m", "translation error [m]"), ("error_deg", "median_deg", "rotation error [deg]"))
        ):
            axes = figure.add_subplot(2, 2, 2 * row + column + 1)
            for algorithm in ALGORITHMS:
                found = answers.searches(algorithm, space)
                cost, colour = [r["evaluations"] for r in found], _COLOURS[algorithm]
                _line(axes, cost, [r[mean] for r in found], colour, f"{algorithm}, mean")
                axes.plot(cost, [r[median] for r in found], ":", color=colour, label=f"{algorithm}, median")
            axes.set(xlabel="fitness evaluations", ylabel=label, title=_space(space))
            logarithmic(axes, "xy")
            axes.grid(alpha=0.3, which="both")
            if row == column == 0:
                axes.legend(fontsize=8)
    file = save_figure(folder / "fig-5-errors.png", figure)
    return Figure(
        file=file, caption="As the paper's Fig. 5: errors of the genetic search over the evaluations it takes."
    )


def draw_times(answers: Answers, folder: Path) -> Figure:
    """Draw Fig. 6: time over success, and beside it evaluations over success."""
    figure = new_figure(11.0, 7.4)
    for row, timed in enumerate((True, False)):
        for column, space in enumerate(answers.plan.configurations):
            axes = figure.add_subplot(2, 2, 2 * row + column + 1)
            for algorithm in ALGORITHMS:
                found = answers.searches(algorithm, space)
                cost = [r["timing"]["search_ms"]["median"] if timed else r["evaluations"] for r in found]
                success = [100 * r["success"]["mean"] for r in found]
                axes.plot(success, cost, "o-", color=_COLOURS[algorithm], label=algorithm, markersize=4)
            axes.set(xlabel="success ratio [%]", ylabel="time [ms]" if timed else "evaluations")
            logarithmic(axes)
            axes.set(title=_space(space), xlim=(0, 101))
            axes.grid(alpha=0.3, which="both")
            axes.legend(fontsize=9)
    file = save_figure(folder / "fig-6-times.png", figure)
    caption = (
        "As the paper's Fig. 6: process time of the genetic search (median, without building the table) against the "
        "success ratio of pre-alignment, 0.30 m and 0.1 rad; below, the same with evaluations in place of time."
    )
    return Figure(file=file, caption=caption)


def draw_grid(answers: Answers, folder: Path) -> Figure:
    """Draw Figs. 7 and 8: success over the errors of the guess."""
    from matplotlib import colormaps

    extent = answers.plan.extent
    figure = new_figure(11.0, 10.5)
    for k, (matcher, title) in enumerate(_PANELS):
        axes = figure.add_subplot(3, 2, k + 1)
        for n, translation in enumerate(extent.translations):
            colour = colormaps["viridis"](0.9 * n / max(len(extent.translations) - 1, 1))
            found = [answers.on_grid(matcher, (translation, r))["success"] for r in extent.rotations]
            _line(axes, extent.rotations, found, colour, f"{translation:g} m", 100.0)
        axes.set(title=title, xlabel="rotation error of the guess [deg]", ylabel="success ratio [%]", ylim=(-3, 103))
        axes.grid(alpha=0.3)
        if k == 0:
            axes.legend(fontsize=9, loc="lower left", title="translation error")
    file = save_figure(folder / "fig-7-8-success.png", figure)
    caption = (
        "As the paper's Figs. 7 and 8: success (0.10 m, 0.01 rad) over the error of the guess; bands are Wilson's 95 %."
    )
    return Figure(file=file, caption=caption)


def draw_iterations(answers: Answers, folder: Path) -> Figure:
    """Draw iterations of MbICP and total time with and without pre-alignment."""
    figure = new_figure(11.0, 4.2)
    left, right = figure.add_subplot(1, 2, 1), figure.add_subplot(1, 2, 2)
    turns = [at[1] for at in PATH]
    for matcher, name, colour in (
        (PLAIN, "MbICP without robust weights", "#969ba3"),
        ("mbicp", "MbICP", "#1f57d6"),
        ("hglasm-g-small", "small, then MbICP", "#148c46"),
        ("hglasm-g-medium", "medium, then MbICP", "#eb7000"),
        ("hglasm-g-large", "large, then MbICP", "#d62728"),
    ):
        found = [answers.on_grid(matcher, at) for at in PATH]
        _line(left, turns, [r["iterations"] for r in found], colour, name)
        right.plot(
            turns, [r["timing"]["total_ms"]["mean"] for r in found], "o-", color=colour, label=name, markersize=4
        )
    labels = [f"{r:g}\n{t:g} m" for t, r in PATH]
    for axes, label in ((left, "iterations of MbICP"), (right, "total time [ms], table included")):
        axes.set(xlabel="rotation [deg] and translation error of the guess", ylabel=label, ylim=(0, None))
        axes.set_xticks(turns, labels, fontsize=8)
        axes.grid(alpha=0.3)
    left.legend(fontsize=8)
    file = save_figure(folder / "iterations-and-times.png", figure)
    return Figure(file=file, caption="What pre-alignment saves MbICP, and what it costs, over the error of the guess.")


def draw_disturbances(answers: Answers, folder: Path) -> Figure:
    """Draw success over added noise and over the number of people, at 0.57 m and 20 deg."""
    figure = new_figure(11.0, 4.2)
    for k, (axis, values, label) in enumerate(
        (
            ("noise", (0.0, *NOISES), "added range noise, SD [m]"),
            ("people", (0, *PEOPLE), "people walking before the laser"),
        )
    ):
        axes = figure.add_subplot(1, 2, k + 1)
        for matcher, colour in zip(AXIS_MATCHERS, _five(), strict=True):
            found = [_disturbed(answers, matcher, axis, value)["success"] for value in values]
            _line(axes, range(len(values)), found, colour, matcher, 100.0)
        axes.set_xticks(range(len(values)), [f"{value:g}" for value in values])
        axes.set(xlabel=label, ylabel="success ratio [%]", ylim=(-3, 103))
        axes.grid(alpha=0.3)
        axes.legend(fontsize=8, loc="lower left")
    file = save_figure(folder / "noise-and-people.png", figure)
    return Figure(
        file=file, caption="Success at 0.57 m and 20 deg with added noise, and with people who walk on by 0.5 m."
    )


def draw_pairs(answers: Answers, folder: Path) -> Figure:
    """Draw success between real scans over their distance, and over the turn between them."""
    buildings = answers.plan.views
    figure = new_figure(4.0 + 4.0 * len(buildings), 5.2)
    columns = len(buildings) + ("intel" in buildings)
    place, colours = 1, dict(zip(PAIR_MATCHERS, _many(len(PAIR_MATCHERS)), strict=True))
    if "intel" in buildings:
        axes = figure.add_subplot(1, columns, place)
        for matcher in PAIR_MATCHERS:
            found = [answers.results[distance_name(matcher, reach)]["success"] for reach in DISTANCES]
            _line(axes, range(len(DISTANCES)), found, colours[matcher], matcher, 100.0)
        axes.set_xticks(range(len(DISTANCES)), [f"{a:g}-{b:g}" for a, b in DISTANCES])
        axes.set(title="Intel, no guess", xlabel="distance [m]", ylabel="success ratio [%]", ylim=(-3, 103))
        axes.grid(alpha=0.3)
        axes.legend(fontsize=7, loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=2)
        place += 1
    for building in buildings:
        axes = figure.add_subplot(1, columns, place)
        for matcher in VIEW_MATCHERS:
            found = [answers.results[view_name(building, matcher, turn)]["success"] for turn in TURNS]
            _line(axes, range(len(TURNS)), found, colours[matcher], matcher, 100.0)
        axes.set_xticks(range(len(TURNS)), [f"{a:g}-{b:g}" for a, b in TURNS])
        axes.set(title=f"{building.capitalize()}, wrong guess", xlabel="turn between the views [deg]", ylim=(-3, 103))
        axes.grid(alpha=0.3)
        axes.legend(fontsize=7, loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=2)
        place += 1
    file = save_figure(folder / "real-pairs.png", figure)
    caption = (
        "Real pairs of scans, success within 0.20 m and 2 deg of the corrected poses. Left: turned by less than 45 "
        "deg, the matcher is told that the robot stood still. Right: views up to 2 m apart, the guess up to 1 m off in "
        "x and y, with any heading."
    )
    return Figure(file=file, caption=caption)


def _line(
    axes: "Axes",
    x: Sequence[float] | range,
    found: Sequence[Mapping[str, Any]],
    colour: Any,
    label: str,
    scale: float = 1.0,
) -> None:
    """Draw means with their intervals as a band."""
    values = [estimate(result) for result in found]
    axes.plot(x, [scale * v.mean for v in values], "o-", color=colour, label=label, markersize=4)
    low, high = ([scale * v for v in side] for side in ([v.low for v in values], [v.high for v in values]))
    axes.fill_between(x, low, high, color=colour, alpha=0.15, linewidth=0)


def _disturbed(answers: Answers, matcher: str, axis: str, value: float) -> dict[str, Any]:
    return answers.disturbed(matcher, noise=value) if axis == "noise" else answers.disturbed(matcher, people=int(value))


def _space(name: str) -> str:
    size = SIZES[name]
    return f"{name} space: +-{size.linear:g} m, +-{np.degrees(size.angular):.0f} deg"


def _five() -> tuple[str, ...]:
    return ("#d62728", "#eb7000", "#148c46", "#1f57d6", "#7b3fb5")


def _many(count: int) -> list[Any]:
    from matplotlib import colormaps

    return [colormaps["tab10"](k) for k in range(count)]
