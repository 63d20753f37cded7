"""The picture of the empty building, drawn once an episode."""

import numpy as np
from PIL import Image

from ..scenes.scene import Outline, Scene
from . import palette
from .canvas import Camera, Canvas

BORDER_M = 1.2
"""Space shown around the building [m]."""


def draw_building(scene: Scene, scale: float) -> tuple[Image.Image, Camera]:
    """Return the building at `scale` pixels a metre, and the camera it was seen with."""
    x_min, y_min, x_max, y_max = scene.bounds
    width, height = x_max - x_min + 2 * BORDER_M, y_max - y_min + 2 * BORDER_M
    camera = Camera(
        ((x_min + x_max) / 2, (y_min + y_max) / 2), scale, (int(np.ceil(width * scale)), int(np.ceil(height * scale)))
    )
    canvas = Canvas(Image.new("RGB", camera.size, palette.OUTSIDE), camera)
    canvas.polygon(scene.floor, palette.FLOOR)
    _tiles(canvas, scene.bounds)
    canvas.line(scene.route, palette.ROUTE, 0.04)
    things = sorted(scene.outlines, key=lambda thing: thing.top)
    for thing in things:
        _shadow(canvas, thing)
    for thing in things:
        canvas.polygon(thing.polygon, *palette.thing(thing.kind, thing.top))
    return canvas.picture, camera


def _tiles(canvas: Canvas, bounds: tuple[float, float, float, float]) -> None:
    x_min, y_min, x_max, y_max = bounds
    for x in np.arange(np.floor(x_min), np.ceil(x_max) + 1):
        canvas.line([(x, y_min), (x, y_max)], palette.GRID, 0.015)
    for y in np.arange(np.floor(y_min), np.ceil(y_max) + 1):
        canvas.line([(x_min, y), (x_max, y)], palette.GRID, 0.015)


def _shadow(canvas: Canvas, thing: Outline) -> None:
    canvas.polygon(thing.polygon + np.array([0.05, -0.07]) * min(thing.top, 1.5), palette.SHADOW)
