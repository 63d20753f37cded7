"""Puts the parts of the top view together."""

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from ..scenes.scene import Scene
from . import palette
from .building import BORDER_M, draw_building
from .canvas import SUPERSAMPLING, Camera, Canvas
from .figures import draw_path, draw_people, draw_robot, draw_scan, draw_tracks
from .layout import SIZE, layout
from .map_panel import MapPanel
from .snapshot import Snapshot


class TopView:
    """Draws snapshots of one episode; the empty building is drawn once."""

    def __init__(self, scene: Scene) -> None:
        self._bounds = scene.bounds
        self._layout = layout(scene.bounds)
        width, height = self._layout.view
        x_min, y_min, x_max, y_max = scene.bounds
        fit = min(width / (x_max - x_min + BORDER_M), height / (y_max - y_min + BORDER_M))
        self._scale = float(np.clip(fit, self._layout.farthest, self._layout.closest)) * SUPERSAMPLING
        self._building, self._whole = draw_building(scene, self._scale)
        self._window = (width * SUPERSAMPLING, height * SUPERSAMPLING)
        self._map = MapPanel(self._layout.map_size, scene.bounds)

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
        picture.paste(self._map.draw(shot), self._layout.map_corner)
        self._captions(picture, shot)
        return np.array(picture)

    def _camera(self, shot: Snapshot) -> Camera:
        """Look at the robot and its leader, if it has one; never far beyond the building."""
        leader = shot.person_positions[shot.leader_index] if shot.leader_index >= 0 else shot.robot_pose[:2]
        offset = leader - shot.robot_pose[:2]
        centre = shot.robot_pose[:2] + offset / max(1.0, float(np.hypot(*offset)) / 0.8) * 0.5
        view = np.array(self._window) / self._scale
        low = np.array(self._bounds[:2]) - BORDER_M / 2 + view / 2
        high = np.array(self._bounds[2:]) + BORDER_M / 2 - view / 2
        centre = np.where(low < high, np.clip(centre, low, high), (low + high) / 2)
        snapped = np.round(centre * self._scale) / self._scale
        return Camera((float(snapped[0]), float(snapped[1])), self._scale, self._window)

    def _background(self, camera: Camera) -> Image.Image:
        left, top = np.round(self._whole.pixels(camera.centre)[0] - np.array(self._window) / 2).astype(int)
        picture = Image.new("RGB", self._window, palette.OUTSIDE)
        picture.paste(self._building, (-int(left), -int(top)))
        return picture

    def _captions(self, picture: Image.Image, shot: Snapshot) -> None:
        draw = ImageDraw.Draw(picture)
        small, large = ImageFont.load_default(13), ImageFont.load_default(22)
        left, top = self._layout.captions
        draw.text((left, top), f"{shot.time_s:.1f} s", fill=palette.PANEL_TEXT, font=large)
        for row, (name, value) in enumerate(shot.captions):
            y = top + 32 + 19 * row
            draw.text((left, y), name, fill=palette.PANEL_MUTED, font=small)
            draw.text((left + 118, y), value, fill=palette.PANEL_TEXT, font=small)
