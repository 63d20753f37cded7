"""Figures of the report."""

from collections.abc import Sequence
from pathlib import Path
from shutil import copyfile

import numpy as np

from ...figures.plots import new_figure, save_figure
from ...lab.cells import files_of
from ..report import Figure
from .drives import CURVE_STEP_S
from .measured import DECIDES, Measured, cell_name

_COLOURS = ("#1f57d6", "#5aa0e8", "#0b7a5a", "#d62728", "#eb7000", "#7a4bb5", "#111111", "#c2a000", "#8c564b")
_LABELS = {
    "convenience": "operator active [s]",
    "time saving": "time to 90 % [s]",
    "motion smoothness": "jerk RMS [m/s3]",
    "safety": "contacts and near misses",
}


def draw_criteria(measured: Measured, folder: Path) -> Figure:
    """Draw the deciding figure of each criterion: every drive a dot, the mean a line."""
    figure, colours = new_figure(12, 8), _colours(measured.guides)
    for place, criterion in enumerate(DECIDES):
        axes = figure.add_subplot(2, 2, place + 1)
        ticks, names = [], []
        for s, scene in enumerate(measured.scenes):
            for g, guide in enumerate(measured.guides):
                convenience = criterion == "convenience"
                values = (
                    measured.values(guide, "active_s", scene)
                    if convenience
                    else measured.burden(guide, criterion, scene)
                )
                x = s * (len(measured.guides) + 1) + g
                spread = np.linspace(-0.25, 0.25, len(values))
                axes.plot(x + spread, values, ".", color=colours[guide], ms=4, alpha=0.5)
                axes.plot([x - 0.35, x + 0.35], [np.nanmean(values)] * 2, color=colours[guide], lw=2.5)
            ticks.append(s * (len(measured.guides) + 1) + (len(measured.guides) - 1) / 2)
            names.append(scene.replace("_", " "))
        axes.set_xticks(ticks, names)
        axes.set(title=criterion, ylabel=_LABELS[criterion])
        axes.set_ylim(bottom=0.0)
        axes.grid(axis="y", alpha=0.3)
    handles = [figure.axes[0].plot([], [], "o", color=colour)[0] for colour in colours.values()]
    figure.legend(handles, colours, loc="outside lower center", ncols=len(measured.guides))
    save_figure(folder / "criteria.png", figure)
    caption = "What decides each criterion, lower is better: every drive (dots) and the mean (line)."
    return Figure(file=folder / "criteria.png", caption=caption)


def draw_coverage(measured: Measured, folder: Path) -> Figure:
    """Draw the mean share of the floor seen over time; who has ended keeps what was seen."""
    figure, colours = new_figure(12, 4), _colours(measured.guides)
    times = np.arange(0.0, measured.limit_s + 1e-9, CURVE_STEP_S)
    for place, scene in enumerate(measured.scenes):
        axes = figure.add_subplot(1, len(measured.scenes), place + 1)
        for guide in measured.guides:
            rows = [measured.row(guide, scene, seed) for seed in measured.seeds]
            curves = [np.append(row["curve"], row["coverage"]) for row in rows]
            padded = [np.pad(c, (0, max(0, len(times) - len(c))), mode="edge")[: len(times)] for c in curves]
            axes.plot(times, 100.0 * np.mean(padded, axis=0), color=colours[guide], lw=2)
        axes.axhline(90.0, color="0.6", lw=1, ls=":")
        axes.set(title=scene.replace("_", " "), xlabel="time [s]", ylabel="floor seen [%]", ylim=(0.0, 101.0))
        axes.grid(alpha=0.3)
    handles = [figure.axes[0].plot([], [], color=colour, lw=2)[0] for colour in colours.values()]
    figure.legend(handles, colours, loc="outside lower center", ncols=len(measured.guides))
    save_figure(folder / "coverage.png", figure)
    return Figure(file=folder / "coverage.png", caption="Share of the floor seen over time, mean of all drives.")


def videos(guides: Sequence[str], scene: str, seed: int, cells: Path, folder: Path) -> list[Figure]:
    """Return the first minute of one drive of each guide."""
    figures = []
    for guide in guides:
        source = files_of(cell_name(guide, scene, seed), cells) / "drive.gif"
        video = folder / f"{guide.replace(':', '-')}.gif"
        copyfile(source, video)
        where = f"{scene.replace('_', ' ')}, seed {seed}"
        figures.append(Figure(file=video, caption=f"{guide}: {where}, 12 times as fast."))
    return figures


def _colours(guides: Sequence[str]) -> dict[str, str]:
    return {guide: _COLOURS[k % len(_COLOURS)] for k, guide in enumerate(guides)}
