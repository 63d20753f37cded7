"""One run as a GIF; its legend has the nine rows of the paper's Table 1."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....slam.geometry import transform_points
from ....slam.landmarks.objects import covariance_ellipse
from ...figures.plots import new_figure
from ...figures.video import save_gif
from ..report import Figure
from .example import Example

Array = NDArray[np.float64]

LEGEND = (
    "robot without odometry error",
    "robot with odometry error",
    "laser: 180 degrees, 8 m",
    "reference trajectory",
    "object in the scene",
    "features of an object",
    "mean of an object's ranges",
    "most probable region of an object",
    "estimated route",
)
"""Table 1 of Urvina et al. 2023, row by row."""
_RANGE = 8.0
_FPS = 8.0


def animate(example: Example, folder: Path, every: int = 2) -> Figure:
    """Write the GIF of EKF-SLAM with DBSCAN, every `every`-th scan used.

    Args:
        example: The arrays of `example_cell`.
        folder: Where to.
        every: Frames are left out in between.
    """
    frames = [_frame(example, k) for k in range(0, len(example["keys"]), every)]
    save_gif(folder / "run.gif", frames, _FPS, width=900)
    caption = (
        "One run, EKF-SLAM with DBSCAN; the legend has the nine rows of the paper's Table 1. Ellipses as in eq. 17: "
        "the object's covariance plus that of odometry alone."
    )
    return Figure(file=folder / "run.gif", caption=caption)


def _frame(example: Example, k: int) -> NDArray[np.uint8]:
    """Return the picture (h, w, 3) at the k-th scan used."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.patches import Ellipse, Wedge

    figure = new_figure(9.0, 5.6)
    axes = figure.add_subplot()
    estimate, true = example["dbscan_slam_poses"], example["path"][example["keys"][k]]
    here = estimate[k]
    edge = float(np.degrees(here[2]))
    axes.add_patch(Wedge(tuple(here[:2]), _RANGE, edge - 90.0, edge + 90.0, fc="0.9", ec="#d62728", lw=1.0, zorder=0))
    handles: dict[str, Any] = {LEGEND[2]: Wedge((0, 0), 1, 0, 1, fc="0.9", ec="#d62728")}
    handles[LEGEND[3]] = axes.plot(*example["path"][:, :2].T, color="0.55", lw=1.2)[0]
    handles[LEGEND[4]] = axes.plot(*example["posts"].T, "ko", ms=4)[0]
    points = transform_points(here, example["points"][example["points_scan"] == k])
    handles[LEGEND[5]] = axes.plot(*points.T, ".", color="#00b000", ms=9)[0]
    means = transform_points(here, example["dbscan_means"][example["dbscan_scan"] == k])
    for mean, total in zip(means, example["dbscan_totals"][example["dbscan_scan"] == k], strict=True):
        shape = covariance_ellipse(mean, total)
        width, height = 2.0 * shape.semi_axes[0], 2.0 * shape.semi_axes[1]
        axes.add_patch(Ellipse(shape.centre, width, height, angle=np.degrees(shape.angle), fill=False, ec="#1f57d6"))
    handles[LEGEND[6]] = axes.plot(*means.T, "o", color="#a000e0", ms=5)[0]
    handles[LEGEND[7]] = Ellipse((0, 0), 1, 1, fill=False, ec="#1f57d6")
    handles[LEGEND[8]] = axes.plot(*estimate[: k + 1, :2].T, ".", color="#39b7e6", ms=4)[0]
    handles[LEGEND[0]] = _robot(axes, true, "#0b7a5a")
    handles[LEGEND[1]] = _robot(axes, example["odometry"][k], "#eb7000")
    low, high = example["posts"].min(axis=0) - 1.0, example["posts"].max(axis=0) + 1.0
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
    figure.legend([handles[name] for name in LEGEND], LEGEND, loc="outside right center", fontsize=8)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3].copy()


def _robot(axes: Any, pose: Array, colour: str) -> Any:
    shape = np.array([(0.6, 0.0), (-0.35, 0.35), (-0.35, -0.35), (0.6, 0.0)])
    corners = transform_points(pose, shape)
    return axes.fill(*corners.T, color=colour, zorder=5)[0]
