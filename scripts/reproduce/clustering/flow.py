"""The flow of the method as a diagram (Urvina et al. 2023, Figures 1 and 2)."""

from pathlib import Path
from typing import Any

from ...figures.plots import new_figure, save_figure
from ..report import Figure

_STEPS = (
    "start: poses of both robots\n(eq. 16, with atan2)",
    "laser sweep: 181 beams, 8 m",
    "cluster the points\nheuristic / K-Means / GMM / DBSCAN",
    "mean and covariance of every object\n(eq. 17: plus the odometry's)",
    "associate with the landmarks\n(gates, joint compatibility; a slip?)",
    "measurement update\n(eq. 18-22, put right)",
    "new landmarks in, false ones out",
    "time update by the wheels\n(eq. 23-26, put right)",
)
_BRANCHES = (
    ("heuristic", "cut where consecutive points\nare far apart (eq. 1)"),
    ("K-Means", "1 to 12 objects (eq. 2-4);\nelbow or silhouette"),
    ("GMM", "EM, full covariance (eq. 5-12);\nelbow or BIC"),
    ("DBSCAN", "dense neighbourhoods (eq. 13);\nnoise stays out"),
)


def draw_flow(folder: Path) -> Figure:
    """Draw both diagrams: the four methods, and the loop of the filter."""
    figure = new_figure(12, 8)
    methods, loop = figure.add_subplot(1, 2, 1), figure.add_subplot(1, 2, 2)
    for axes in (methods, loop):
        axes.set(xlim=(0, 10), ylim=(0, 16.6))
        axes.axis("off")
    _methods(methods)
    _loop(loop)
    caption = "Figures 1 and 2: what each method does, and the loop around it."
    return Figure(file=save_figure(folder / "flow.png", figure), caption=caption)


def _methods(axes: Any) -> None:
    _box(axes, 5.0, 15.4, "points of one sweep", "#dbe8ff", 5.0)
    _box(axes, 8.0, 1.0, "ellipse: eigenvectors\nof the covariance", "#e3f4e3", 3.2)
    _box(axes, 5.0, 3.4, "mean and covariance of every object", "#e3f4e3", 6.4)
    for row, (name, words) in enumerate(_BRANCHES):
        y = 13.0 - 2.3 * row
        _box(axes, 2.4, y, name, "#fff0d8", 2.6)
        _box(axes, 6.6, y, words, "#fff7ea", 5.0)
        _arrow(axes, (3.7, y), (4.1, y))
        _line(axes, (0.6, 15.4), (0.6, y))
        _arrow(axes, (0.6, y), (1.1, y))
        _line(axes, (9.1, y), (9.6, y))
    _line(axes, (2.5, 15.4), (0.6, 15.4))
    _line(axes, (9.6, 13.0), (9.6, 3.4))
    _arrow(axes, (9.6, 3.4), (8.2, 3.4))
    _arrow(axes, (8.0, 2.7), (8.0, 1.7))
    _box(axes, 3.4, 1.0, "centre of the round object,\nits covariance: to the filter", "#e3f4e3", 5.0)
    _arrow(axes, (3.4, 2.7), (3.4, 1.7))


def _loop(axes: Any) -> None:
    top, step = 15.4, 1.95
    for row, words in enumerate(_STEPS):
        y = top - step * row
        _box(axes, 5.4, y, words, "#dbe8ff" if row in (0, 1) else "#fff7ea" if row < 4 else "#e3f4e3", 6.6)
        if row:
            _arrow(axes, (5.4, y + step - 0.65), (5.4, y + 0.65))
    last = top - step * (len(_STEPS) - 1)
    _line(axes, (2.1, last), (1.0, last))
    _line(axes, (1.0, last), (1.0, top - step))
    _arrow(axes, (1.0, top - step), (2.1, top - step))
    axes.text(0.7, 8.0, "until the trajectory ends", rotation=90, ha="center", va="center", fontsize=9)
    _arrow(axes, (5.4, last - 0.65), (5.4, 0.75))
    axes.text(5.4, 0.45, "map and route", ha="center", va="center", fontsize=9)


def _box(axes: Any, x: float, y: float, words: str, colour: str, width: float) -> None:
    from matplotlib.patches import FancyBboxPatch

    corner = (x - width / 2.0, y - 0.6)
    axes.add_patch(FancyBboxPatch(corner, width, 1.2, boxstyle="round,pad=0.05", fc=colour, ec="0.4"))
    axes.text(x, y, words, ha="center", va="center", fontsize=8)


def _line(axes: Any, start: tuple[float, float], end: tuple[float, float]) -> None:
    axes.plot((start[0], end[0]), (start[1], end[1]), color="0.4", lw=1)


def _arrow(axes: Any, start: tuple[float, float], end: tuple[float, float]) -> None:
    axes.annotate("", end, start, arrowprops={"arrowstyle": "->", "color": "0.4"})
