"""Figures of the sensors: update curves, sensing ranges, one scene by each sensor, the planes of a frame."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ....envs.camera.config import RgbdConfig
from ....perception.rgbd.planes import Surface
from ....slam.geometry import transform_points
from ...figures.plots import new_figure, save_figure
from ..report import Figure
from .drives import LASER
from .exhibits import Exhibit

Array = NDArray[np.float64]

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
    probability = np.linspace(0.0, 0.95, 200)
    axes.plot(probability, probability / (1.0 - probability), "k", lw=2.5, label="occupancy grid, P / (1 - P)")
    for lam in _LAMBDAS:
        axes.plot(probability, lam * probability, label=f"immobile area, lambda = {lam:g}")
    axes.axhline(1.0, color="0.6", lw=1, ls=":")
    axes.set(xlabel="probability of an object, P(O)", ylabel="factor of the odds", xlim=(0.0, 1.0), ylim=(0.0, 10.0))
    axes.legend()
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
    far, high = camera.range_max, camera.camera_height
    slope = np.tan(camera.vertical_fov / 2.0)
    side.fill([0.0, far, far], [high, high + far * slope, high - far * slope], color="#d62728", alpha=0.3)
    side.plot([0.0, LASER.range_max], [LASER.height] * 2, color="#20a0c8", lw=3)
    side.axhline(0.0, color="k")
    side.axhline(2.6, color="0.5", ls=":")
    side.annotate("ceiling", (9.0, 2.65))
    side.set(title="from the side", xlabel="ahead [m]", ylabel="height [m]", ylim=(-0.1, 3.2), xlim=(-0.5, 10.5))
    save_figure(folder / "fig3_ranges.png", figure)
    caption = "Fig. 3: the laser sees 270 degrees at 0.32 m, the camera 70 x 60 degrees from 1.00 m, on the same axis."
    return Figure(file=folder / "fig3_ranges.png", caption=caption)


def draw_scene(exhibit: Exhibit, folder: Path) -> Figure:
    """Draw Fig. 4: one scene, the laser's returns, the camera's points from above."""
    figure = new_figure(15, 5)
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
    laser.set(ylabel="ahead [m]")
    save_figure(folder / "fig4_scene.png", figure)
    caption = "Fig. 4: the laser sees far and wide in one plane; the camera sees narrower, and in space."
    return Figure(file=folder / "fig4_scene.png", caption=f"{caption} {_LEGEND}")


def draw_planes(exhibit: Exhibit, folder: Path) -> Figure:
    """Draw Fig. 5: the planes of one frame."""
    figure = new_figure(15, 3.2)
    masks = [("floor", Surface.FLOOR), ("ceiling", Surface.CEILING), ("walls", Surface.WALL)]
    pictures = [("colour", exhibit.colour), ("all planes", _coloured(exhibit))]
    for name, surface in masks:
        mine = (exhibit.surface == surface) & ~exhibit.person
        pictures.append((name, np.where(mine[..., None], exhibit.colour, np.uint8(25))))
    for place, (name, image) in enumerate(pictures):
        axes = figure.add_subplot(1, len(pictures), place + 1)
        axes.imshow(image, interpolation="nearest")
        axes.set(title=name, xticks=[], yticks=[])
    save_figure(folder / "fig5_planes.png", figure)
    return Figure(file=folder / "fig5_planes.png", caption=f"Fig. 5: the planes of that frame. {_LEGEND}")


_LEGEND = (
    "Floor brown, ceiling light blue, walls red, tops blue, other upright planes green, people yellow, the rest grey."
)


def _coloured(exhibit: Exhibit) -> NDArray[np.uint8]:
    image = np.zeros((*exhibit.surface.shape, 3), dtype=np.uint8)
    for surface, colour in _COLOURS.items():
        image[exhibit.surface == surface] = colour
    image[exhibit.person] = _PERSON
    return image
