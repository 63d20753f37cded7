"""Figures of the sensors: update curves, sensing ranges, one scene by each sensor, the planes of a frame."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ....envs.sensors.camera.config import RgbdConfig
from ....perception.rgbd.planes import Surface
from ....slam.geometry import transform_points
from ...figures.plots import name_colours, new_figure, save_figure
from ..report import Figure
from .drives import LASER
from .exhibits import Exhibit

Array = NDArray[np.float64]

_CEILING_M = 2.6
_LAMBDAS = (0.5, 1.0, 2.0, 4.0, 6.0, 10.0)
_COLOURS = {
    Surface.NOTHING: (0, 0, 0),
    Surface.OTHER: (150, 150, 150),
    Surface.FLOOR: (130, 95, 60),
    Surface.CEILING: (80, 170, 240),
    Surface.WALL: (225, 60, 60),
    Surface.TOP: (40, 80, 220),
    Surface.FACE: (90, 190, 120),
}
_PERSON = (250, 200, 40)


def draw_curves(folder: Path) -> Figure:
    """Draw Fig. 1: by what an observation multiplies the odds, over the probability of an object."""
    figure = new_figure(7, 4.5)
    axes = figure.add_subplot()
    probability = np.linspace(0.0, 1.0, 400)
    axes.plot(
        probability[:-1], (1.0 / (1.0 - probability[:-1])) - 1.0, "k", lw=2.5, label="occupancy grid: P / (1 - P)"
    )
    for lam in reversed(_LAMBDAS):  # from top to bottom, as the lines lie
        axes.plot(probability, lam * probability, label=f"immobile area: lambda P, lambda = {lam:g}")
    axes.axhline(1.0, color="0.4", lw=1, ls=":")
    axes.annotate("the odds stay as they are", (0.995, 1.1), ha="right", color="0.3", fontsize=8)
    axes.set(
        title="What one observation does to a cell",
        xlabel="probability of an object, P(O)",
        ylabel="the odds are multiplied by",
        xlim=(0.0, 1.0),
        ylim=(0.0, 10.0),
    )
    axes.legend(loc="upper left")
    axes.grid(alpha=0.3)
    save_figure(folder / "fig1_curves.png", figure)
    caption = "Fig. 1: what one observation multiplies the odds of a cell by; at 1 nothing changes."
    return Figure(file=folder / "fig1_curves.png", caption=caption)


def draw_ranges(folder: Path) -> Figure:
    """Draw Fig. 3: what the sensors reach, from above and from the side."""
    camera, figure = RgbdConfig(), new_figure(12, 5.5)
    above, side = figure.add_subplot(1, 2, 1), figure.add_subplot(1, 2, 2)
    for reach, fov, colour, name in (
        (LASER.range_max, LASER.field_of_view, "#20a0c8", "laser"),
        (camera.range_max, camera.horizontal_fov, "#d62728", "camera"),
    ):
        angles = np.linspace(-fov / 2.0, fov / 2.0, 100)
        arc = reach * np.stack((np.cos(angles), np.sin(angles)), axis=-1)
        sector = np.concatenate((np.zeros((1, 2)), arc, np.zeros((1, 2))))
        above.fill(sector[:, 0], sector[:, 1], color=colour, alpha=0.3, label=f"{name}, {np.degrees(fov):.0f} deg")
    above.plot(0.0, 0.0, "k^", ms=8)
    above.set(title="from above", xlabel="ahead [m]", ylabel="to the left [m]", aspect="equal")
    above.legend(loc="upper left")
    ahead = np.linspace(camera.range_min, camera.range_max, 200)
    slope = np.tan(camera.vertical_fov / 2.0)
    lowest, highest = camera.camera_height - slope * ahead, camera.camera_height + slope * ahead
    side.fill_between(ahead, np.maximum(lowest, 0.0), np.minimum(highest, _CEILING_M), color="#d62728", alpha=0.3)
    side.plot([LASER.range_min, LASER.range_max], [LASER.height] * 2, color="#20a0c8", lw=3)
    side.plot([0.0, 0.0], [0.0, camera.camera_height], "k", lw=3)
    side.axhline(0.0, color="k")
    side.axhline(_CEILING_M, color="0.5", ls=":")
    for text, place in (
        ("ceiling", (0.1, _CEILING_M + 0.05)),
        (
            f"camera, {np.degrees(camera.vertical_fov):.0f} deg, {camera.range_min:g} to {camera.range_max:g} m",
            (3.2, 1.4),
        ),
        (f"laser, at {LASER.height:.2f} m, to {LASER.range_max:g} m", (5.0, LASER.height + 0.06)),
        ("robot", (0.1, 0.05)),
    ):
        side.annotate(text, place)
    side.set(title="from the side", xlabel="ahead [m]", ylabel="height [m]", ylim=(-0.1, 3.0), xlim=(-0.5, 10.5))
    save_figure(folder / "fig3_ranges.png", figure)
    caption = "Fig. 3: the laser sees 270 degrees at 0.32 m, the camera 70 x 60 degrees from 1.00 m, on the same axis."
    return Figure(file=folder / "fig3_ranges.png", caption=caption)


def draw_scene(exhibit: Exhibit, folder: Path) -> Figure:
    """Draw Fig. 4: one scene, the laser's returns, the camera's points from above."""
    figure = new_figure(15, 5.4)
    picture, laser, camera = (figure.add_subplot(1, 3, place) for place in (1, 2, 3))
    picture.imshow(exhibit.colour, interpolation="nearest")
    picture.set(title=f"the scene at {float(exhibit.time_s):.0f} s", xticks=[], yticks=[])
    points = exhibit.scan
    laser.plot(-points[:, 1], points[:, 0], ".", color="#20a0c8", ms=2)
    seen = np.isfinite(exhibit.depth)
    where = transform_points(exhibit.camera, exhibit.points[seen][:, :2])
    colour = _coloured(exhibit)[seen] / 255.0
    thing = ~np.isin(exhibit.surface[seen], (Surface.FLOOR, Surface.CEILING))
    camera.scatter(-where[thing, 1], where[thing, 0], s=2, c=colour[thing])
    for axes, title in ((laser, "by the laser"), (camera, "by the camera (floor and ceiling left out)")):
        axes.plot(0.0, 0.0, "r^", ms=9)
        axes.set(title=title, aspect="equal", xlim=(-6.0, 6.0), ylim=(-2.0, 9.0), xlabel="to the right [m]")
        axes.set(ylabel="ahead [m]")
    name_colours(figure, _LEGEND)
    save_figure(folder / "fig4_scene.png", figure)
    caption = "Fig. 4: the laser sees far and wide in one plane; the camera sees narrower, and in space."
    return Figure(file=folder / "fig4_scene.png", caption=caption)


def draw_planes(exhibit: Exhibit, folder: Path) -> Figure:
    """Draw Fig. 5: the planes of one frame."""
    figure = new_figure(15, 3.6)
    masks = [("floor", Surface.FLOOR), ("ceiling", Surface.CEILING), ("walls", Surface.WALL)]
    pictures = [("colour", exhibit.colour), ("all planes", _coloured(exhibit))]
    for name, surface in masks:
        mine = (exhibit.surface == surface) & ~exhibit.person
        pictures.append((name, np.where(mine[..., None], exhibit.colour, np.uint8(25))))
    for place, (name, image) in enumerate(pictures):
        axes = figure.add_subplot(1, len(pictures), place + 1)
        axes.imshow(image, interpolation="nearest")
        axes.set(title=name, xticks=[], yticks=[])
    name_colours(figure, _LEGEND)
    save_figure(folder / "fig5_planes.png", figure)
    return Figure(file=folder / "fig5_planes.png", caption="Fig. 5: the planes of that frame.")


_NAMES = {
    Surface.FLOOR: "floor",
    Surface.CEILING: "ceiling",
    Surface.WALL: "wall",
    Surface.TOP: "level top",
    Surface.FACE: "other upright plane",
    Surface.OTHER: "no plane",
    Surface.NOTHING: "not measured, or at an edge",
}


_LEGEND = {**{name: _COLOURS[surface] for surface, name in _NAMES.items()}, "somebody": _PERSON}


def _coloured(exhibit: Exhibit) -> NDArray[np.uint8]:
    image = np.zeros((*exhibit.surface.shape, 3), dtype=np.uint8)
    for surface, colour in _COLOURS.items():
        image[exhibit.surface == surface] = colour
    image[exhibit.person] = _PERSON
    return image
