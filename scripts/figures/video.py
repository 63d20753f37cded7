"""A drive as an animated GIF: plays anywhere, needs no codec."""

import os
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from ...slam.errors import InputError
from ...slam.files.output import replacing

_COLOURS = 96


def save_gif(path: str | os.PathLike[str], frames: Sequence[NDArray[np.uint8]], fps: float, width: int = 720) -> None:
    """Write pictures as a GIF that loops, whole or not at all; equal pictures give equal bytes.

    All frames share the colours of one in the middle, without dithering, so that what stands still costs nothing.

    Args:
        path: Where to.
        frames: Pictures (h, w, 3) of one size.
        fps: Frames a second [1/s].
        width: Width of the GIF [pixels]; narrower pictures stay as they are.

    Raises:
        InputError: If there is no frame.
    """
    if not frames:
        raise InputError("a GIF needs at least one frame, got none")
    pictures = [_scaled(Image.fromarray(frame), width) for frame in frames]
    palette = pictures[len(pictures) // 2].quantize(_COLOURS)
    indexed = [picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in pictures]
    with replacing(path) as temporary:
        indexed[0].save(
            temporary,
            format="GIF",
            save_all=True,
            append_images=indexed[1:],
            duration=round(1000 / fps),
            loop=0,
            optimize=False,
        )


def _scaled(picture: Image.Image, width: int) -> Image.Image:
    if picture.width <= width:
        return picture
    return picture.resize((width, round(picture.height * width / picture.width)), Image.Resampling.LANCZOS)
