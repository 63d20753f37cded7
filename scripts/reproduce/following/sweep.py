"""When does filtering matter? Usable range x odometry x people x engine."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...figures.plots import new_figure, save_figure
from ..report import Figure, Section, Table
from .judgement import METRICS, Pair, pair
from .maps import VARIANTS
from .plan import ParameterSweep
from .tables import TITLES

Array = NDArray[np.float64]

DRAWN = {
    "ate": "pose error (ATE)",
    "adnn": "ADNN by equation 7: reference to map",
    "map_to_truth": "ADNN, map to truth",
}
"""Metrics of the heat maps."""
BREAKS = 5.0
"""Raw over filtered by equation 7 from which raw mapping breaks as in the paper."""
_SHOWN = np.log2(10.0)  # colours end at a ratio of ten


@dataclass(frozen=True)
class Point:
    """One cell of the sweep."""

    scene: str
    variant: str
    usable: float
    odometry: str
    people: int

    @property
    def text(self) -> str:
        """In words."""
        where = f"{TITLES[self.scene]}, {VARIANTS[self.variant]}"
        return f"{where}, {self.usable:.0f} m, {self.odometry}, {self.people} people"


@dataclass(frozen=True, eq=False)
class SweepResults:
    """The results of the sweep.

    Attributes:
        results: What the cells returned, by name.
        sweep: What was gone through.
    """

    results: Mapping[str, Any]
    sweep: ParameterSweep

    def points(self) -> Iterator[Point]:
        """Yield every cell."""
        s = self.sweep
        for scene in s.scenes:
            for usable in s.ranges:
                for odometry in s.odometry:
                    for variant in s.variants(odometry):
                        for people in s.people:
                            yield Point(scene, variant, usable, odometry, people)

    def pair(self, metric: str, p: Point) -> Pair:
        """Return a metric from raw and from filtered scans."""
        seeds = range(self.sweep.repeats)
        return pair(self.results, metric, p.scene, p.people, p.odometry, p.usable, p.variant, seeds)

    def numbers(self) -> list[dict[str, Any]]:
        """Return means, ratio and verdict of every metric in every cell, for results.json."""
        rows = []
        for point in self.points():
            figures = {}
            for metric in METRICS:
                found = self.pair(metric, point)
                if np.isfinite(found.raw).any():
                    figures[metric] = {
                        "raw": float(np.nanmean(found.raw)),
                        "filtered": float(np.nanmean(found.filtered)),
                        "ratio": found.ratio,
                        "gain": found.gain.to_dict(),
                        "verdict": found.verdict,
                    }
            rows.append({**vars(point), "metrics": figures})
        return rows

    def breaking(self) -> list[Point]:
        """Return the cells in which raw mapping breaks as in the paper."""
        return [point for point in self.points() if self.pair("adnn", point).ratio >= BREAKS]


def sweep_section(swept: SweepResults, figures: list[Figure]) -> Section:
    """Return the section about the sweep."""
    breaking = swept.breaking()
    words = (
        f"By equation 7 the raw map is at least {BREAKS:.0f} times as far off as the filtered one in "
        f"{len(breaking)} of {sum(1 for _ in swept.points())} cells."
        if breaking
        else f"In no cell of this sweep is the raw map {BREAKS:.0f} times as far off by equation 7 as the filtered one."
    )
    return Section(
        title="When does filtering matter?",
        text=f"{_METHOD}\n\n{words}",
        tables=[_count_table(swept), _extreme_table(swept)],
        figures=figures,
    )


_METHOD = """\
Every drive of the sweep is cut to a usable range, and mapped from raw and from filtered scans. The reference of
equation 7 is the engine's own map of the slow drive with typical odometry at full range. Where wheels slip, GMapping
is run a second time with an update every 0.2 m and 0.2 rad. With 0 people the robot drives alone: what the filter then
removes, it removes in error."""


def _count_table(swept: SweepResults) -> Table:
    rows = []
    for variant in dict.fromkeys(point.variant for point in swept.points()):
        for metric, name in {**DRAWN, "residue": "cells left by people"}.items():
            verdicts = [swept.pair(metric, point).verdict for point in swept.points() if point.variant == variant]
            counts = (str(verdicts.count(word)) for word in ("better", "no effect", "worse"))
            rows.append((f"{VARIANTS[variant]}: {name}", *counts))
    columns = ("cells of the sweep in which filtering is", "better", "no effect", "worse")
    note = (
        f"By the 95 % interval of the paired difference over {swept.sweep.repeats} drives; few drives, wide intervals, "
        "and not corrected for how many there are: one in twenty would leave out zero by chance."
    )
    return Table(title="Verdicts", columns=columns, rows=rows, note=note)


def _extreme_table(swept: SweepResults, count: int = 8) -> Table:
    """Return the cells in which filtering changes the pose error or the map most, both ways."""
    ranked = sorted(swept.points(), key=lambda point: -np.nan_to_num(swept.pair("adnn", point).ratio, nan=1.0))
    chosen = ranked if len(ranked) <= 2 * count else ranked[:count] + ranked[-count:]
    rows = []
    for point in chosen:
        words = [point.text]
        for metric in DRAWN:
            found = swept.pair(metric, point)
            words.append(f"{100 * np.mean(found.raw):.1f} -> {100 * np.mean(found.filtered):.1f} ({found.ratio:.2f})")
        rows.append(tuple(words))
    columns = ("raw -> filtered (ratio)", *(f"{name} [cm]" for name in DRAWN.values()))
    return Table(title="Where filtering changes most by equation 7, both ways", columns=columns, rows=rows)


def draw_heat_maps(swept: SweepResults, folder: Path) -> list[Figure]:
    """Draw raw over filtered of each metric as heat maps."""
    return [_heat_map(swept, metric, title, folder) for metric, title in DRAWN.items()]


def _heat_map(swept: SweepResults, metric: str, title: str, folder: Path) -> Figure:
    s = swept.sweep
    variants = list(dict.fromkeys(point.variant for point in swept.points()))
    lines = [(usable, odometry) for usable in s.ranges for odometry in s.odometry]
    figure = new_figure(3.2 + 2.6 * len(variants), 1.2 + (0.9 + 0.28 * len(lines)) * len(s.scenes))
    image = None
    for row, scene in enumerate(s.scenes):
        for column, variant in enumerate(variants):
            axes = figure.add_subplot(len(s.scenes), len(variants), row * len(variants) + column + 1)
            ratios = _ratios(swept, metric, scene, variant, lines)
            image = axes.imshow(np.log2(ratios), cmap="RdBu", vmin=-_SHOWN, vmax=_SHOWN, aspect="auto")
            for (i, j), ratio in np.ndenumerate(ratios):
                if np.isfinite(ratio):
                    dark = abs(np.log2(ratio)) > 0.6 * _SHOWN
                    colour = "w" if dark else "k"
                    axes.text(j, i, ratio_text(ratio), ha="center", va="center", fontsize=8, color=colour)
            axes.set_xticks(range(len(s.people)), [str(count) for count in s.people])
            labels = [f"{usable:.0f} m, {odometry}" for usable, odometry in lines]
            axes.set_yticks(range(len(lines)), labels if column == 0 else [""] * len(lines), fontsize=8)
            axes.set_title(f"{TITLES[scene]}\n{VARIANTS[variant]}", fontsize=8)
            axes.set_xlabel("people", fontsize=8)
    if image is not None:
        ticks = np.log2([0.1, 0.25, 0.5, 1, 2, 4, 10])
        bar = figure.colorbar(image, ax=figure.axes, ticks=ticks, shrink=0.8, extend="both")
        bar.ax.set_yticklabels(["0.1", "0.25", "0.5", "1", "2", "4", "10"])
    figure.suptitle(f"{title}: raw over filtered", fontsize=10)
    path = save_figure(folder / f"sweep_{metric}.png", figure)
    caption = f"{title}, raw over filtered: blue, filtering helps; red, it harms. Mean of {s.repeats} drives."
    return Figure(file=path, caption=caption)


def ratio_text(ratio: float) -> str:
    """Return two digits of a ratio, never with an exponent."""
    return f"{ratio:.0f}" if ratio >= 10.0 else f"{ratio:.2g}"


def _ratios(swept: SweepResults, metric: str, scene: str, variant: str, lines: list[tuple[float, str]]) -> Array:
    ratios = np.full((len(lines), len(swept.sweep.people)), np.nan)
    for i, (usable, odometry) in enumerate(lines):
        if variant in swept.sweep.variants(odometry):
            for j, people in enumerate(swept.sweep.people):
                ratios[i, j] = swept.pair(metric, Point(scene, variant, usable, odometry, people)).ratio
    return ratios
