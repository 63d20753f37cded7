"""Drawing in metres on a picture of pixels."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from PIL import Image, ImageDraw, ImageFont

Colour = tuple[int, int, int] | tuple[int, int, int, int]
SUPERSAMPLING = 2
"""Pictures are drawn this many times larger and then reduced: smooth edges."""


@dataclass(frozen=True)
class Camera:
    """Which part of the plane a picture shows.

    Attributes:
        centre: (x, y) in the middle of the picture [m].
        scale: Pixels of the drawing (before reduction) per metre.
        size: (width, height) of the drawing [pixel].
    """

    centre: tuple[float, float]
    scale: float
    size: tuple[int, int]

    def pixels(self, points: ArrayLike) -> NDArray[np.float64]:
        """Return (n, 2) pixel coordinates of `points` (n, 2) [m]; y points up in the world and down in the picture."""
        offset = (np.asarray(points, dtype=np.float64).reshape(-1, 2) - self.centre) * self.scale
        return np.stack((self.size[0] / 2.0 + offset[:, 0], self.size[1] / 2.0 - offset[:, 1]), axis=1)


class Canvas:
    """Shapes in metres, drawn with alpha on an RGB picture."""

    def __init__(self, picture: Image.Image, camera: Camera) -> None:
        self.picture, self.camera = picture, camera
        self._draw = ImageDraw.Draw(picture, "RGBA")

    def polygon(self, points: ArrayLike, fill: Colour, outline: Colour | None = None) -> None:
        """Fill the polygon `points` (n, 2) [m]."""
        self._draw.polygon(self._flat(points), fill=fill, outline=outline)

    def line(self, points: ArrayLike, colour: Colour, width_m: float) -> None:
        """Draw a line through `points` (n, 2) [m]."""
        width = max(1, round(width_m * self.camera.scale))
        self._draw.line(self._flat(points), fill=colour, width=width, joint="curve")

    def circle(
        self,
        centre: ArrayLike,
        radius_m: float,
        fill: Colour | None,
        outline: Colour | None = None,
        width_m: float = 0.0,
    ) -> None:
        """Draw a circle around `centre` (2,) [m]."""
        x, y = self.camera.pixels(centre)[0]
        r, width = radius_m * self.camera.scale, max(1, round(width_m * self.camera.scale))
        self._draw.ellipse((x - r, y - r, x + r, y + r), fill=fill, outline=outline, width=width)

    def arc(self, centre: ArrayLike, radius_m: float, start: float, end: float, colour: Colour, width_m: float) -> None:
        """Draw an arc around `centre` (2,) [m] from angle `start` to `end` [degrees, clockwise on the picture]."""
        x, y = self.camera.pixels(centre)[0]
        r, width = radius_m * self.camera.scale, max(1, round(width_m * self.camera.scale))
        self._draw.arc((x - r, y - r, x + r, y + r), start, end, fill=colour, width=width)

    def dots(self, points: NDArray[np.float64], colour: Colour, size: int) -> None:
        """Draw squares of `size` drawing pixels at `points` (n, 2) [m]; all at once, by numpy."""
        place = np.round(self.camera.pixels(points)).astype(np.intp)
        inside = np.all((place >= 0) & (place < np.array(self.camera.size) - size), axis=1)
        place = place[inside]
        for dx in range(size):
            for dy in range(size):
                self._draw.point((place + np.array([dx, dy])).ravel().tolist(), fill=colour)

    def label(self, position: ArrayLike, text: str, colour: Colour, size_px: int) -> None:
        """Write `text` centred on `position` (2,) [m]."""
        x, y = self.camera.pixels(position)[0]
        font = ImageFont.load_default(size_px)
        self._draw.text((x, y), text, fill=colour, font=font, anchor="mm")

    def _flat(self, points: ArrayLike) -> list[float]:
        return self.camera.pixels(points).ravel().tolist()
