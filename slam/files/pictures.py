"""Decodes pictures (PNG, JPEG, BMP and others) of files and messages; what is wrong with one is told in a line."""

from typing import Any

from PIL import Image, UnidentifiedImageError

from ..errors import InputError


def decoded(file: Any, most_pixels: int | None = None) -> Image.Image:
    """Return the picture in a file, or what acts like one.

    Args:
        file: Opened for reading.
        most_pixels: A picture that states more is not decoded.

    Raises:
        InputError: If it is no picture, or a damaged or too large one.
    """
    try:
        picture = Image.open(file)
        if most_pixels is not None and picture.width * picture.height > most_pixels:
            raise InputError(f"a picture has at most {most_pixels} pixels here, got {picture.width} x {picture.height}")
        picture.load()
    except InputError:
        raise
    except UnidentifiedImageError as error:  # which names what it was given, not the file
        raise InputError("is no picture that can be read") from error
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError) as error:
        raise InputError(f"is no picture that can be read ({error})") from error
    return picture
