"""Planes and people of one camera frame, drawn over its colour."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from ...perception.rgbd.people import RgbdPeople
from ...perception.rgbd.planes import Planes, Surface
from ...slam.files.output import replacing

_TINTS = {
    Surface.FLOOR: (40, 200, 40),
    Surface.CEILING: (200, 60, 200),
    Surface.WALL: (70, 90, 255),
    Surface.TOP: (255, 160, 0),
    Surface.FACE: (0, 210, 220),
}
_PERSON = (255, 50, 50)
_WIDE = 640


def draw_planes(planes: Planes, people: RgbdPeople) -> NDArray[np.uint8]:
    """Return a picture about 640 columns wide: surfaces tinted, people red with likelihood and distance [m]."""
    colour = planes.frame.colour.astype(np.float64)
    for surface, tint in _TINTS.items():
        mine = planes.surface == surface
        colour[mine] = 0.6 * colour[mine] + 0.4 * np.array(tint)
    colour[planes.surface == Surface.NOTHING] *= 0.4
    mine = people.label >= 0
    colour[mine] = 0.4 * colour[mine] + 0.6 * np.array(_PERSON)
    scale = max(1, round(_WIDE / planes.frame.camera.width))
    picture = Image.fromarray(np.kron(colour.astype(np.uint8), np.ones((scale, scale, 1), dtype=np.uint8)))
    draw = ImageDraw.Draw(picture)
    mount = planes.mount
    told = "seen" if mount.floor_seen else "by what is known" if mount.known else "unknown"
    pitch, roll = np.degrees(planes.tilt)
    text = f"floor {told}: {mount.height:.2f} m, pitch {pitch:.1f}, roll {roll:.1f} deg"
    draw.text((4.0, 4.0), text, fill=(255, 255, 255), stroke_width=1, stroke_fill=(0, 0, 0))
    for k in range(len(people)):
        rows, cols = np.nonzero(people.label == k)
        if len(rows):
            text = f"{people.likelihood[k]:.2f}  {np.hypot(*people.positions[k]):.1f} m"
            at = (float(cols.mean()) * scale - 25.0, max(float(rows.min()) * scale - 12.0, 16.0))
            draw.text(at, text, fill=(255, 255, 0), stroke_width=1, stroke_fill=(0, 0, 0))
    return np.asarray(picture)


def save_planes(path: Path, planes: Planes, people: RgbdPeople) -> None:
    """Write what `draw_planes` draws to `path` (.png)."""
    with replacing(path) as temporary:
        Image.fromarray(draw_planes(planes, people)).save(temporary, format="png")
