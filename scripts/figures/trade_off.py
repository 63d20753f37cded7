"""What costs what, a colour a follower: calm driving tours, and staying close the bystanders their room."""

from collections.abc import Sequence
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING

from ..lab.cell_comparison import TITLES, ComparedCell
from ..lab.statistics import Estimate
from .plots import new_figure, save_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes

DONE = "done"
TRADE_OFFS = (("jerk_rms_mps3", DONE), ("distance_error_rms_m", "personal_space_compliance"))
"""Figures of the plots, x and y."""
_COLUMNS = 3


def draw_trade_off(cells: Sequence[ComparedCell], path: Path) -> Path:
    """Draw tours done over jerk, and personal space kept over the error of the distance, each with its 95 % interval.

    Args:
        cells: Two plots each, one above the other, a colour a follower.
        path: PNG file to write.
    """
    columns = min(_COLUMNS, len(cells))
    rows = -(-len(cells) // columns)
    figure = new_figure(4.2 * columns, 3.2 * rows * len(TRADE_OFFS))
    for (band, pair), (place, cell) in product(enumerate(TRADE_OFFS), enumerate(cells)):
        axes = figure.add_subplot(len(TRADE_OFFS) * rows, columns, band * rows * columns + place + 1)
        points = {who: [_estimate(cell, who, key) for key in pair] for who in cell.done}
        for who, (x, y) in points.items():
            _point(axes, who, x, y)
        axes.set(title=f"{cell.name}, {cell.episodes} episodes", xlabel=TITLES[pair[0]])
        least = min(y.low for _, y in points.values())
        axes.set(ylabel=TITLES.get(pair[1], "tours done"), ylim=(min(0.8, least - 0.02), 1.01))
        axes.set_xlim(left=0.0)
        axes.grid(alpha=0.3)
        axes.legend(loc="lower left")
    return save_figure(path, figure)


def _estimate(cell: ComparedCell, who: str, key: str) -> Estimate:
    return cell.done[who] if key == DONE else cell.means[who][key]


def _point(axes: "Axes", who: str, x: Estimate, y: Estimate) -> None:
    spans = [[[v.mean - v.low], [v.high - v.mean]] for v in (x, y)]
    axes.errorbar(x.mean, y.mean, spans[1], spans[0], "o", capsize=3, label=who)
