"""Figures of the report, numbered as in the paper."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....slam.geometry import transform_points
from ....slam.landmarks.objects import covariance_ellipse
from ...figures.plots import logarithmic, new_figure, save_figure
from ...lab.statistics import Estimate, t_mean
from ..report import Figure
from .cells import DISTANCES, NEIGHBOURS, REACHES
from .drives import ROBOTS
from .example import COLUMNS, Example
from .judgement import Consistency, Worlds
from .methods import METHODS, PAPER

Array = NDArray[np.float64]

COLOURS = dict(zip(METHODS, ("#1f57d6", "#eb7000", "#f4a860", "#d62728", "#e98b8c", "#0b7a5a"), strict=True))
_TITLES = {"odometry": "without EKF", "slam": "with EKF", "lost": "with EKF, landmarks lost for 6 m"}
_MEDIAN = {"color": "black", "linewidth": 1.5}
_MAGNIFIED = 10.0  # ellipses of landmarks in Figure 6, which could not be seen else
_ELLIPSE, _ROUTE, _GROUND = "#1f57d6", "#39b7e6", "0.55"


def draw_times(worlds: Worlds, folder: Path) -> Figure:
    """Figure 3: execution time of each method."""
    figure = new_figure(11, 4.2)
    for place, (title, values) in enumerate(
        (("clustering a scan [ms]", worlds.cluster_ms), ("whole drive [s]", worlds.total_s))
    ):
        axes = figure.add_subplot(1, 2, place + 1)
        boxes = axes.boxplot([values(name) for name in METHODS], patch_artist=True, widths=0.6, medianprops=_MEDIAN)
        for box, name in zip(boxes["boxes"], METHODS, strict=True):
            box.set_facecolor(COLOURS[name])
        axes.set_xticks(range(1, len(METHODS) + 1), list(METHODS.values()), rotation=25, ha="right")
        axes.set(ylabel=title)
        logarithmic(axes)
        axes.grid(axis="y", alpha=0.3)
    caption = "Figure 3: time by method, one box over all worlds, CPU time of one thread, logarithmic."
    return Figure(file=save_figure(folder / "figure3_time.png", figure), caption=caption)


def draw_errors(worlds: Worlds, folder: Path) -> Figure:
    """Figure 4: accumulated error of each method, robot by robot, and ATE."""
    figure = new_figure(11, 7)
    for row, (figure_of, label) in enumerate((("y_sum_m", "accumulated error of y [m]"), ("ate_m", "ATE [m]"))):
        for column, (robot, title) in enumerate(ROBOTS.items()):
            axes = figure.add_subplot(2, 2, 2 * row + column + 1)
            values = [worlds.error(name, robot, "slam", figure_of) for name in METHODS]
            boxes = axes.boxplot(values, patch_artist=True, widths=0.6, medianprops=_MEDIAN)
            for box, name in zip(boxes["boxes"], METHODS, strict=True):
                box.set_facecolor(COLOURS[name])
            axes.set_xticks(range(1, len(METHODS) + 1), list(METHODS.values()), rotation=25, ha="right")
            axes.set(ylabel=label, title=title)
            logarithmic(axes)
            axes.grid(axis="y", alpha=0.3)
    caption = "Figure 4: accumulated error of y where x coincides, and ATE below; EKF-SLAM, logarithmic."
    return Figure(file=save_figure(folder / "figure4_error.png", figure), caption=caption)


def draw_growth(worlds: Worlds, example: Example, folder: Path) -> Figure:
    """Figure 5: K-Means without update: the ellipses grow, and their area over the way."""
    figure = new_figure(13, 5.6)
    axes = figure.add_subplot(1, 2, 1)
    _ground(axes, example)
    axes.plot(*example["odometry"][:, :2].T, ".", color=_ROUTE, ms=3)
    kept = example["kmeans_scan"] % 9 == 0
    poses = example["odometry"][example["kmeans_scan"][kept]]
    for pose, mean, total in zip(poses, example["kmeans_means"][kept], example["kmeans_totals"][kept], strict=True):
        place = transform_points(pose, mean[None])[0]
        _ellipse(axes, place, total)
        axes.plot(*place, ".", color="#b07bd0", ms=3)
    axes.set_title("objects of every ninth scan, placed by odometry")
    axes = figure.add_subplot(1, 2, 2)
    ways, areas = _areas(worlds)
    axes.plot(ways, np.nanmean(areas, axis=0), color=COLOURS["kmeans"], lw=2)
    low, high = np.nanquantile(areas, [0.05, 0.95], axis=0)
    axes.fill_between(ways, low, high, color=COLOURS["kmeans"], alpha=0.2)
    axes.set(xlabel="way [m]", ylabel="area of an ellipse [m²]", title="all worlds: mean, 5 to 95 %")
    axes.grid(alpha=0.3)
    caption = (
        "Figure 5: K-Means alone, without update. An ellipse is two standard deviations of the object's covariance "
        "plus the odometry's (eq. 17). Left one world, right the area over the way."
    )
    return Figure(file=save_figure(folder / "figure5_ellipses.png", figure), caption=caption)


def _areas(worlds: Worlds) -> tuple[Array, Array]:
    """Return ways (w,) [m] and, at each, the mean area in every world (worlds, w), NaN where it showed nothing."""
    longest = min(row["growth"]["arc_m"][-1] for row in worlds.rows)
    ways = np.arange(1.0, longest, 2.0)
    areas = []
    for row in worlds.rows:
        arc, area = np.array(row["growth"]["arc_m"]), np.array(row["growth"]["area_m2"])
        areas.append(np.interp(ways, arc[area >= 0.0], area[area >= 0.0]))
    return ways, np.array(areas)


def draw_dynamics(example: Example, folder: Path) -> Figure:
    """Figure 6: four methods times three dynamics."""
    figure = new_figure(13, 17)
    for row, name in enumerate(PAPER):
        for column, kind in enumerate(COLUMNS):
            axes = figure.add_subplot(len(PAPER), len(COLUMNS), row * len(COLUMNS) + column + 1)
            _ground(axes, example)
            poses = example["odometry"] if kind == "odometry" else example[f"{name}_{kind}_poses"]
            axes.plot(*poses[:, :2].T, ".-", color=_ROUTE, ms=3, lw=0.8)
            if kind == "odometry":
                kept = example[f"{name}_scan"] % 12 == 0
                at = poses[example[f"{name}_scan"][kept]]
                places = [
                    transform_points(p, m[None])[0] for p, m in zip(at, example[f"{name}_means"][kept], strict=True)
                ]
                covariances = example[f"{name}_totals"][kept]
            else:
                places, covariances = example[f"{name}_{kind}_landmarks"], example[f"{name}_{kind}_covariances"]
            for place, covariance in zip(places, covariances, strict=True):
                _ellipse(axes, place, covariance * (1.0 if kind == "odometry" else _MAGNIFIED**2))
            if kind == "lost":
                axes.plot(*poses[example["covered"], :2].T, ".", color="#d62728", ms=5)
            axes.set_title(f"{METHODS[name]}, {_TITLES[kind]}", fontsize=9)
    caption = (
        "Figure 6: light blue the estimated route, grey line the true one, black the posts, blue ellipses (two "
        "standard deviations) objects or, ten times enlarged, landmarks; red the stretch without landmarks. Robot 2."
    )
    return Figure(file=save_figure(folder / "figure6_dynamics.png", figure), caption=caption)


def draw_consistency(found: Consistency, folder: Path) -> Figure:
    """Draw the average NEES over the steps, and its bounds."""
    figure = new_figure(11, 3.6)
    axes = figure.add_subplot()
    axes.plot(found.average, color=COLOURS["dbscan"], lw=1)
    for bound in (found.low, found.high):
        axes.axhline(bound, color="#d62728", lw=1, ls="--")
    axes.axhline(3.0, color="0.6", lw=1)
    axes.set(xlabel="step (0.1 s)", ylabel="average NEES of the pose", ylim=(0.0, max(6.0, 1.05 * found.average.max())))
    caption = "Average NEES; red the 95 % bounds of a filter whose covariance is right."
    return Figure(file=save_figure(folder / "nees.png", figure), caption=caption)


def draw_sweeps(rows: Sequence[Mapping[str, Any]], folder: Path) -> Figure:
    """Draw error over the three parameters."""
    figure = new_figure(13, 4)
    titles = {"distance": "minimum cluster distance [m]", "neighbours": "minimum neighbours", "range": "range [m]"}
    for place, (key, title) in enumerate(titles.items()):
        axes = figure.add_subplot(1, 3, place + 1)
        values = {"distance": DISTANCES, "neighbours": NEIGHBOURS, "range": REACHES}[key]
        for name in PAPER:
            means = [_mean_error(rows, f"{name}/{key}/{value}") for value in values]
            if all(mean is None for mean in means):
                continue
            error = [[100.0 * (m.mean - m.low) for m in means if m], [100.0 * (m.high - m.mean) for m in means if m]]
            on_top = {"ls": "--", "mfc": "white", "zorder": 3} if name == "heuristic" else {}
            style = {"marker": "o", "ms": 5, "capsize": 3, "lw": 1.4, **on_top}
            at = [value for value, mean in zip(values, means, strict=True) if mean]
            heights = [100.0 * m.mean for m in means if m]
            axes.errorbar(at, heights, error, color=COLOURS[name], label=METHODS[name], **style)
        axes.set(xlabel=title, ylabel="RMS error [cm]")
        logarithmic(axes)
        axes.grid(alpha=0.3)
        axes.legend(fontsize=8)
    caption = (
        "The paper's three parameters; mean and 95 % interval. Heuristic (open circles) and DBSCAN mostly lie on each "
        "other; K-Means and GMM, which have none of the first two, on fewer worlds."
    )
    return Figure(file=save_figure(folder / "sweeps.png", figure), caption=caption)


def _mean_error(rows: Sequence[Mapping[str, Any]], point: str) -> Estimate | None:
    """Return the mean error of the worlds [m] that have tried `point`."""
    errors = [row[point]["rms_m"] for row in rows if point in row]
    return t_mean(errors, least=0.0) if errors else None


def _ground(axes: Any, example: Example) -> None:
    axes.plot(*example["path"][:, :2].T, color=_GROUND, lw=1.2)
    axes.plot(*example["posts"].T, "o", color="black", ms=3)
    axes.set_aspect("equal")
    axes.set_xlabel("x [m]", fontsize=7)
    axes.set_ylabel("y [m]", fontsize=7)
    axes.tick_params(labelsize=7)


def _ellipse(axes: Any, place: Array, covariance: Array) -> None:
    from matplotlib.patches import Ellipse as Patch

    shape = covariance_ellipse(place, covariance)
    axes.add_patch(
        Patch(
            shape.centre,
            2.0 * shape.semi_axes[0],
            2.0 * shape.semi_axes[1],
            angle=float(np.degrees(shape.angle)),
            fill=False,
            edgecolor=_ELLIPSE,
            lw=1.0,
        )
    )
