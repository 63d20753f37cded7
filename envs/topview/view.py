"""Puts the parts of the top view together."""

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from ..scenes.scene import Scene
from . import palette
from .building import BORDER_M, draw_building
from .canvas import SUPERSAMPLING, Camera, Canvas
from .figures import draw_path, draw_people, draw_robot, draw_scan, draw_tracks
from .map_panel import map_picture
from .snapshot import Snapshot

SIZE = (960, 540)
"""Width and height of a picture [pixel]."""
CLOSEST = 62.0
"""Most pixels a metre: small rooms do not fill the view with one person."""
FARTHEST = 46.0
"""Fewest pixels a metre: in larger buildings the view moves with the robot."""
STRIP = 150
"""Height of the strip below with the map and the captions [pixel]."""


class TopView:
    """Draws snapshots of one episode; the empty building is drawn once."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        width, height = SIZE[0], SIZE[1] - STRIP
        x_min, y_min, x_max, y_max = scene.bounds
        fit = min(width / (x_max - x_min + BORDER_M), height / (y_max - y_min + BORDER_M))
        self._scale = float(np.clip(fit, FARTHEST, CLOSEST)) * SUPERSAMPLING
        self._building, self._whole = draw_building(scene, self._scale)
        self._window = (width * SUPERSAMPLING, height * SUPERSAMPLING)

    def draw(self, shot: Snapshot) -> NDArray[np.uint8]:
        """Return the picture (540, 960, 3) of `shot`."""
        camera = self._camera(shot)
        canvas = Canvas(self._background(camera), camera)
        draw_scan(canvas, shot)
        draw_path(canvas, shot.path)
        draw_robot(canvas, shot.robot_pose, shot.robot_size)
        draw_people(canvas, shot)
        draw_tracks(canvas, shot.tracks, shot.robot_pose)
        picture = Image.new("RGB", SIZE, palette.PANEL)
        picture.paste(canvas.picture.reduce(SUPERSAMPLING), (0, 0))
        self._strip(picture, shot)
        return np.array(picture)

    def _camera(self, shot: Snapshot) -> Camera:
        """Look at the robot and its leader; never far beyond the building."""
        offset = shot.person_positions[shot.leader_index] - shot.robot_pose[:2]
        centre = shot.robot_pose[:2] + offset / max(1.0, float(np.hypot(*offset)) / 0.8) * 0.5
        view = np.array(self._window) / self._scale
        low = np.array(self._scene.bounds[:2]) - BORDER_M + view / 2
        high = np.array(self._scene.bounds[2:]) + BORDER_M - view / 2
        middle = (low + high) / 2
        centre = np.where(low < high, np.clip(centre, low, high), middle)
        snapped = np.round(centre * self._scale) / self._scale
        return Camera((float(snapped[0]), float(snapped[1])), self._scale, self._window)

    def _background(self, camera: Camera) -> Image.Image:
        left, top = np.round(self._whole.pixels(camera.centre)[0] - np.array(self._window) / 2).astype(int)
        picture = Image.new("RGB", self._window, palette.OUTSIDE)
        picture.paste(self._building, (-int(left), -int(top)))
        return picture

    def _strip(self, picture: Image.Image, shot: Snapshot) -> None:
        top = SIZE[1] - STRIP
        panel = (SIZE[0] - 330, STRIP - 16)
        picture.paste(map_picture(panel, self._scene, shot), (8, top + 8))
        draw = ImageDraw.Draw(picture)
        small, large = ImageFont.load_default(13), ImageFont.load_default(22)
        left = SIZE[0] - 306
        draw.text((left, top + 10), f"{shot.time_s:6.1f} s".strip(), fill=palette.PANEL_TEXT, font=large)
        for row, (name, value) in enumerate(shot.captions):
            y = top + 42 + 19 * row
            draw.text((left, y), name, fill=palette.PANEL_MUTED, font=small)
            draw.text((left + 118, y), value, fill=palette.PANEL_TEXT, font=small)
