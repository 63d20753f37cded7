"""Pictures of a piece of the plane, drawn with Pillow alone: title, scale bar, legend, points, lines and cells."""

import os
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray
from PIL import Image, ImageDraw, ImageFont

from ...slam.files.output import replacing

Colour = tuple[int, int, int]

INK: Colour = (28, 30, 34)
PAPER: Colour = (255, 255, 255)
FAINT: Colour = (150, 155, 163)
RED: Colour = (214, 39, 40)
BLUE: Colour = (31, 87, 214)
ORANGE: Colour = (235, 112, 0)
GREEN: Colour = (20, 140, 70)

_FINE = 2  # everything is drawn this many times larger and then averaged down, so that lines have smooth edges
_MARGIN, _TITLE_BAND, _LEGEND_BAND, _LEGEND_LINE = 24, 52, 54, 30
_TEXT, _TITLE = 19, 24
_ROUND = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0)  # lengths of scale bars [m]


class PlanCanvas:
    """A white sheet that shows the rectangle `low` .. `high` of the plane, y upwards.

    Args:
        low: (x, y) lower left corner of the shown rectangle [m].
        high: (x, y) upper right corner [m].
        title: Line above the plan.
        size: Largest (width, height) of the plan itself [px].
    """

    def __init__(self, low: ArrayLike, high: ArrayLike, title: str = "", size: tuple[int, int] = (1300, 900)) -> None:
        self._low = np.asarray(low, dtype=np.float64)
        extent = np.maximum(np.asarray(high, dtype=np.float64) - self._low, 1e-3)
        self.pixels_per_metre = float(np.min(np.asarray(size) / extent))
        self._plan = np.maximum(np.ceil(extent * self.pixels_per_metre), 1).astype(int)
        self._width = max(int(self._plan[0]), 560) + 2 * _MARGIN
        self._top = _TITLE_BAND if title else _MARGIN
        self._left = (self._width - int(self._plan[0])) // 2
        height = self._top + int(self._plan[1]) + _LEGEND_BAND
        self._image = Image.new("RGB", (self._width * _FINE, height * _FINE), PAPER)
        self._draw = ImageDraw.Draw(self._image)
        self._title = title
        self._legend: list[tuple[str, Colour]] = []

    def cells(
        self, points: NDArray[np.float64], side: float, colour: Colour, thinnest: float = 0.0, mix: bool = False
    ) -> None:
        """Fill squares of `side` [m] around `points` (N, 2), never drawn thinner than `thinnest` [px].

        With `mix` the darker of each channel is kept where something is drawn already: colours add up.
        """
        if len(points) == 0:
            return
        width = max(side * self.pixels_per_metre, thinnest) * _FINE
        centre = self._fine(points)
        low, high = np.round(centre - width / 2).astype(int), np.round(centre + width / 2).astype(int)
        high = np.maximum(high, low + 1)
        pixels = np.array(self._image)
        height, width_px = pixels.shape[:2]
        mask = np.zeros((height, width_px), dtype=bool)
        across, down = (high - low).max(axis=0).tolist()
        if len(points) < across * down:  # few large squares, one by one
            for (left, top), (right, bottom) in zip(
                np.maximum(low, 0).tolist(), np.maximum(high, 0).tolist(), strict=True
            ):
                mask[top:bottom, left:right] = True
        else:
            for dx, dy in np.ndindex(across, down):
                x, y = np.minimum(low[:, 0] + dx, high[:, 0] - 1), np.minimum(low[:, 1] + dy, high[:, 1] - 1)
                inside = (x >= 0) & (y >= 0) & (x < width_px) & (y < height)
                mask[y[inside], x[inside]] = True
        ink = np.array(colour, dtype=np.uint8)
        pixels[mask] = np.minimum(pixels[mask], ink) if mix else ink
        self._image.paste(Image.fromarray(pixels))

    def line(self, points: ArrayLike, colour: Colour, width: float = 2.5) -> None:
        """Draw a line through `points` (N, 2) [m], `width` [px]."""
        corners = self._fine(np.asarray(points, dtype=np.float64))
        if len(corners) > 1:
            self._draw.line([tuple(p) for p in corners], fill=colour, width=round(width * _FINE), joint="curve")

    def dots(self, points: ArrayLike, colour: Colour, radius: float = 2.0) -> None:
        """Draw round dots at `points` (N, 2) [m], `radius` [px]."""
        for x, y in self._fine(np.asarray(points, dtype=np.float64).reshape(-1, 2)):
            r = radius * _FINE
            self._draw.ellipse((x - r, y - r, x + r, y + r), fill=colour)

    def circle(self, centre: ArrayLike, radius: float, colour: Colour, width: float = 1.0) -> None:
        """Draw a circle of `radius` [m] around `centre` (2,), the line `width` [px] thick."""
        x, y = self._fine(np.asarray(centre, dtype=np.float64)[None])[0]
        r = radius * self.pixels_per_metre * _FINE
        self._draw.ellipse((x - r, y - r, x + r, y + r), outline=colour, width=max(round(width * _FINE), 1))

    def polygon(self, corners: ArrayLike, fill: Colour, outline: Colour | None = None) -> None:
        """Fill the polygon with `corners` (N, 2) [m]."""
        points = [tuple(p) for p in self._fine(np.asarray(corners, dtype=np.float64))]
        self._draw.polygon(points, fill=fill, outline=outline, width=2 * _FINE)

    def label(self, at: ArrayLike, text: str, colour: Colour = INK, size: int = _TEXT, anchor: str = "mm") -> None:
        """Write `text` at a place of the plane (2,) [m]; `anchor` as Pillow names it ("lm": left, middle)."""
        x, y = self._fine(np.asarray(at, dtype=np.float64)[None])[0] / _FINE
        self._text((x, y), text, colour, size, anchor)

    def legend(self, entries: Sequence[tuple[str, Colour]]) -> None:
        """Add lines that say what the colours mean; they stand below the plan."""
        self._legend.extend(entries)

    def finished(self) -> Image.Image:
        """Return the picture, with title, legend and a scale bar of a round length."""
        self._blank_borders()
        if self._title:
            self._text((_MARGIN, _TITLE_BAND / 2), self._title, INK, _TITLE, "lm")
        self._write_legend(end=self._draw_scale_bar() - _MARGIN)
        size = (self._image.width // _FINE, self._image.height // _FINE)
        return self._image.resize(size, Image.Resampling.BOX)

    def _blank_borders(self) -> None:
        """Paint over what was drawn outside of the plan."""
        width, height = self._image.size
        left, top = self._left * _FINE, self._top * _FINE
        right, bottom = left + int(self._plan[0]) * _FINE, top + int(self._plan[1]) * _FINE
        for box in ((0, 0, width, top), (0, bottom, width, height), (0, 0, left, height), (right, 0, width, height)):
            self._draw.rectangle(box, fill=PAPER)

    def _write_legend(self, end: float) -> None:
        """Write the legend below the plan, in as many lines as it takes to stay left of `end` [px]."""
        x, y = float(_MARGIN), self._image.height / _FINE - _LEGEND_BAND / 2
        for name, colour in self._legend:
            width = 24 + self._draw.textlength(name, _font(_TEXT * _FINE)) / _FINE
            if x > _MARGIN and x + width > end:
                x, y = float(_MARGIN), y + _LEGEND_LINE
                self._grow(_LEGEND_LINE)
            box = (x, y - 8, x + 16, y + 8)
            self._draw.rectangle([v * _FINE for v in box], fill=colour, outline=FAINT, width=_FINE)
            self._text((x + 24, y), name, INK, _TEXT, "lm")
            x += width + 26

    def _grow(self, height: int) -> None:
        """Add `height` [px] of blank sheet at the bottom."""
        sheet = Image.new("RGB", (self._image.width, self._image.height + height * _FINE), PAPER)
        sheet.paste(self._image)
        self._image, self._draw = sheet, ImageDraw.Draw(sheet)

    def _draw_scale_bar(self) -> float:
        """Draw the scale bar in the lower right corner; returns where its text begins [px from the left]."""
        wanted = 0.18 * self._plan[0] / self.pixels_per_metre
        length = max((r for r in _ROUND if r <= wanted), default=_ROUND[0])
        right, y = self._width - _MARGIN, self._image.height / _FINE - _LEGEND_BAND / 2
        left = right - length * self.pixels_per_metre
        for box in ((left, y - 2, right, y + 2), (left, y - 8, left + 2, y + 8), (right - 2, y - 8, right, y + 8)):
            self._draw.rectangle([v * _FINE for v in box], fill=INK)
        text = f"{length:g} m"
        self._text((left - 10, y), text, INK, _TEXT, "rm")
        return left - 10 - self._draw.textlength(text, _font(_TEXT * _FINE)) / _FINE

    def _fine(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the pixels (N, 2) of the large drawing at `points` (N, 2) [m]."""
        scaled = (points - self._low) * self.pixels_per_metre
        return np.stack((self._left + scaled[:, 0], self._top + self._plan[1] - scaled[:, 1]), axis=-1) * _FINE

    def _text(self, at: tuple[float, float], text: str, colour: Colour, size: int, anchor: str) -> None:
        self._draw.text((at[0] * _FINE, at[1] * _FINE), text, colour, _font(size * _FINE), anchor)


def save_png(path: str | os.PathLike[str], image: Image.Image) -> None:
    """Write a picture as PNG, whole or not at all; equal pictures give equal bytes."""
    with replacing(path) as temporary:
        image.save(temporary, format="PNG", optimize=False)


def side_by_side(pictures: Sequence[Image.Image]) -> Image.Image:
    """Return the pictures in one row, their tops aligned."""
    sheet = Image.new("RGB", (sum(p.width for p in pictures), max(p.height for p in pictures)), PAPER)
    x = 0
    for picture in pictures:
        sheet.paste(picture, (x, 0))
        x += picture.width
    return sheet


def stacked(pictures: Sequence[Image.Image]) -> Image.Image:
    """Return the pictures in one column, their left sides aligned."""
    sheet = Image.new("RGB", (max(p.width for p in pictures), sum(p.height for p in pictures)), PAPER)
    y = 0
    for picture in pictures:
        sheet.paste(picture, (0, y))
        y += picture.height
    return sheet


def _font(size: int) -> ImageFont.ImageFont | ImageFont.FreeTypeFont:
    return ImageFont.load_default(size)
