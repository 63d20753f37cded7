"""The paper's pictures of how it works: lookup patterns (Fig. 2), search boxes (Fig. 3), one match (Fig. 4)."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ....slam.geometry import transform_points
from ....slam.scan_to_scan.genetic import SIZES
from ....slam.scan_to_scan.lookup import LookupConfig, build_lookup
from ...figures.plots import new_figure, save_figure
from ..report import Figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_BLUE, _GREEN, _RED, _GREY = "#1f57d6", "#148c46", "#d62728", "#969ba3"
_SHOWN = 9.0  # points farther from the reference's laser are outside of the picture [m]
SIZE_COLOURS = {"small": _GREEN, "medium": "#eb7000", "large": _RED}


def draw_patterns(folder: Path) -> Figure:
    """Draw Fig. 2: what both lookup tables mark around one point."""
    figure = new_figure(8.0, 4.0)
    point = np.zeros(2)  # where four cells meet, so that the patterns are as even as they can be
    for k, (pattern, title) in enumerate(
        (("gaussian", "GLASM-g: radial, 8 bits"), ("square", "GLASM: square, binary"))
    ):
        grid = build_lookup(point[None], LookupConfig(pattern=pattern))  # pyright: ignore[reportArgumentType]
        rows, cols = grid.values.shape
        x0, y0 = grid.origin
        extent = (x0, x0 + cols * grid.resolution, y0, y0 + rows * grid.resolution)
        axes = figure.add_subplot(1, 2, k + 1)
        axes.imshow(grid.values, cmap="gray_r", vmin=0, vmax=255, origin="lower", extent=extent)
        axes.plot(*point, "+", color=_RED, markersize=10)
        axes.set(title=title, xlabel="x [m]", ylabel="y [m]", xlim=(-0.8, 0.8), ylim=(-0.8, 0.8))
    file = save_figure(folder / "fig-2-lookup-patterns.png", figure)
    config = LookupConfig()
    caption = (
        f"As the paper's Fig. 2: the lookup tables around one point (cross), black is a full hit. Cells of "
        f"{config.cell:g} m; Gaussian of {config.sigma:g} m to a radius of {config.radius:g} m, square of "
        f"+-{config.half_side:g} m: the paper leaves these open."
    )
    return Figure(file=file, caption=caption)


def draw_boxes(folder: Path) -> Figure:
    """Draw Fig. 3: the three search spaces."""
    figure = new_figure(8.0, 4.6)
    plane, turn = figure.add_subplot(1, 2, 1), figure.add_subplot(1, 2, 2)
    for row, (name, size) in enumerate(reversed(SIZES.items())):
        half, angle, colour = size.linear, np.degrees(size.angular), SIZE_COLOURS[name]
        square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]]) * half
        plane.plot(*square.T, color=colour, label=f"{name}: +-{half:g} m")
        plane.fill(*square.T, color=colour, alpha=0.12)
        turn.barh(row, 2 * angle, left=-angle, color=colour, alpha=0.6)
        turn.text(
            0,
            row,
            f"{name}: +-{angle:.1f} deg, {size.population} x {size.generations} x {size.runs}",
            ha="center",
            va="center",
        )
    plane.plot(0, 0, "k+", markersize=10)
    plane.set(xlabel="x [m]", ylabel="y [m]", aspect="equal", title="translations")
    plane.set(ylim=(-2.1, 3.3))
    plane.legend(loc="upper center", fontsize=9)
    turn.set(xlabel="rotation [deg]", yticks=[], xlim=(-185, 185), title="rotations; population x generations x runs")
    file = save_figure(folder / "fig-3-search-spaces.png", figure)
    return Figure(file=file, caption="As the paper's Fig. 3 and Table 1: the search spaces around the guess.")


def draw_example(found: Mapping[str, Any], folder: Path) -> Figure:
    """Draw Fig. 4 from the result of the cell `example`."""
    figure = new_figure(12.0, 7.6)
    reference, new = np.array(found["reference"]), np.array(found["new"])
    near = reference[np.hypot(*reference.T) < _SHOWN]
    low, high = near.min(axis=0) - 1.5, near.max(axis=0) + 1.5
    panels: list[tuple[str, NDArray[np.float64], NDArray[np.float64] | None]] = [
        ("the guess (green) and the reference (blue)", np.array(found["guess"]), None)
    ]
    for g, poses in found["generations"].items():
        best = int(np.argmax(found["fitness"][g]))
        panels.append((f"after {g} generations", np.array(poses)[best], np.array(poses)))
    panels.append(("MbICP, first step", np.array(found["first_step"]), None))
    panels.append((f"MbICP, last step ({found['iterations']})", np.array(found["last_step"]), None))
    for k, (title, pose, population) in enumerate(panels):
        axes = figure.add_subplot(2, 3, k + 1)
        axes.plot(*reference.T, ".", color=_BLUE, markersize=5)
        if population is not None:
            _draw_population(axes, population)
        axes.plot(*transform_points(pose, new).T, ".", color=_GREEN if k == 0 else _RED, markersize=4)
        axes.set(title=title, xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
        axes.tick_params(labelsize=8)
    file = save_figure(folder / "fig-4-one-match.png", figure)
    caption = (
        "As the paper's Fig. 4: the guess, the population (grey arrows) with its best individual's scan (red) after 0, "
        "5 and 12 generations in the large space, then the first and the last step of MbICP. Metres."
    )
    return Figure(file=file, caption=caption)


def _draw_population(axes: "Axes", poses: NDArray[np.float64]) -> None:
    axes.quiver(
        poses[:, 0], poses[:, 1], np.cos(poses[:, 2]), np.sin(poses[:, 2]),
        color=_GREY, scale=24, width=0.004, headwidth=4,
    )  # fmt: skip
