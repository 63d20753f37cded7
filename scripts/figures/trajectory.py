"""Pictures of trajectories on a map."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from ...slam.occupancy_map import OccupancyMap
from .canvas import BLUE, GREEN, INK, ORANGE, RED, Colour
from .maps import map_canvas

_COLOURS: tuple[Colour, ...] = (BLUE, ORANGE, GREEN, (140, 60, 170), (120, 85, 60))
_START, _END = GREEN, RED


def trajectory_picture(
    grid: OccupancyMap, trajectories: Mapping[str, NDArray[np.float64]], title: str = ""
) -> Image.Image:
    """Return a picture of `grid` with each trajectory (n, 3) [m, m, rad] drawn on it under its name.

    The first trajectory is drawn last, on top, with a green dot at its start and a red one at its end.
    """
    drawn = {name: poses[:, :2] for name, poses in trajectories.items() if len(poses)}
    everything = np.vstack([np.empty((0, 2)), *drawn.values()])
    canvas = map_canvas(grid, title, everything)
    colours = dict(zip(drawn, _COLOURS * len(drawn), strict=False))
    for name, points in reversed(drawn.items()):
        canvas.line(points, colours[name])
    if drawn:
        first = next(iter(drawn.values()))
        canvas.dots(first[:1], _START, 6.0)
        canvas.dots(first[-1:], _END, 6.0)
    canvas.legend([("occupied", INK), *colours.items(), ("start", _START), ("end", _END)])
    return canvas.finished()
