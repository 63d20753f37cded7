"""People found in camera frames, as a picture."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from ...perception.rgbd.frame import RgbdFrame
from ...perception.rgbd.people import RgbdPeople
from ...slam.files.output import replacing

_TINTS = np.array([(255, 80, 60), (60, 160, 255), (90, 230, 90), (255, 200, 40), (230, 90, 230), (60, 230, 220)])
_SCALE = 3
_ACROSS = 4


def save_detections(path: Path, seen: Sequence[tuple[RgbdFrame, RgbdPeople]]) -> None:
    """Write the frames to `path` (.png), people tinted, with likelihood and distance [m] written over them."""
    tiles = [_tile(frame, people) for frame, people in seen]
    height, width = tiles[0].shape[:2]
    rows = -(-len(tiles) // _ACROSS)
    sheet = np.zeros((rows * height, min(_ACROSS, len(tiles)) * width, 3), dtype=np.uint8)
    for number, tile in enumerate(tiles):
        row, col = divmod(number, _ACROSS)
        sheet[row * height : (row + 1) * height, col * width : (col + 1) * width] = tile
    with replacing(path) as temporary:
        Image.fromarray(sheet).save(temporary, format="png")


def _tile(frame: RgbdFrame, people: RgbdPeople) -> NDArray[np.uint8]:
    colour = frame.colour.astype(np.float64)
    inside = people.label >= 0
    colour[inside] = 0.5 * colour[inside] + 0.5 * _TINTS[people.label[inside] % len(_TINTS)]
    large = np.kron(colour.astype(np.uint8), np.ones((_SCALE, _SCALE, 1), dtype=np.uint8))
    picture = Image.fromarray(large)
    draw = ImageDraw.Draw(picture)
    for k in range(len(people)):
        rows, cols = np.nonzero(people.label == k)
        if not len(rows):
            continue
        text = f"{people.likelihood[k]:.2f}  {np.hypot(*people.positions[k]):.1f} m"
        at = (
            min(float(cols.mean()) * _SCALE - 25.0, large.shape[1] - 70.0),
            max(float(rows.min()) * _SCALE - 12.0, 0.0),
        )
        draw.text(at, text, fill=(255, 255, 0), stroke_width=1, stroke_fill=(0, 0, 0))
    return np.asarray(picture)
