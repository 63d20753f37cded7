"""Reads the image of a map: a PGM, or any other picture that ROS map_server takes, such as a PNG."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from .input import Source, checked_name, names_file, opened
from .pgm import MOST_BYTES, is_pgm, read_pgm
from .pictures import decoded
from .sizes import MOST_PIXELS

_WHY = f"a map's image has at most {MOST_PIXELS} pixels"
_DEEP = ("I;16", "I;16B", "I;16L", "I")  # 16 bits a pixel, as PNG has them


@dataclass(frozen=True, eq=False)
class MapImage:
    """Shades of grey.

    Attributes:
        shades: (rows, cols) uint8, top row first; 0 is black.
        white: Which shade is white.
        clear: (rows, cols) where the image is transparent; None: nowhere.
    """

    shades: NDArray[np.uint8]
    white: int = 255
    clear: NDArray[np.bool_] | None = None


@names_file
def read_map_image(path: Source) -> MapImage:
    """Return the image of a map; of colours their brightness.

    Raises:
        InputError: If the file cannot be read, is no picture, or has more than `MOST_PIXELS` pixels.
    """
    with opened(path, MOST_BYTES, _WHY) as file:
        if not is_pgm(file.read(2)):
            file.seek(0)
            return _of_picture(decoded(file, MOST_PIXELS))
    return MapImage(*read_pgm(checked_name(path)))


def _of_picture(picture: Image.Image) -> MapImage:
    if picture.mode in _DEEP:
        return MapImage((np.asarray(picture) >> 8).astype(np.uint8))
    if picture.mode not in ("LA", "RGBA") and "transparency" not in picture.info:
        return MapImage(np.asarray(picture.convert("L")))
    seen = picture.convert("RGBA")
    clear = np.asarray(seen.getchannel("A")) < 255
    return MapImage(np.asarray(seen.convert("L")), clear=clear if clear.any() else None)
