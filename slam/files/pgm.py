"""Reads grey images in the format PGM, binary (P5) or text (P2), of up to 256 shades."""

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError, shown
from .input import named, read_bytes
from .sizes import MOST_PIXELS

MOST_BYTES = 4 * MOST_PIXELS + 4096
"""Of the image of a map: a pixel as text takes up to three digits and a blank."""
_HEADER_WITHIN = 4096  # bytes: a comment may stand in it
_BLANK = rb"(?:\s|#[^\n]*\n)+"
_HEADER = re.compile(rb"(P[25])" + _BLANK + rb"(\d{1,9})" + _BLANK + rb"(\d{1,9})" + _BLANK + rb"(\d{1,9})\s")


def is_pgm(start: bytes) -> bool:
    """Return whether a file that begins with these two bytes is a PGM."""
    return start in (b"P5", b"P2")


def read_pgm(path: Path) -> tuple[NDArray[np.uint8], int]:
    """Return the shades (rows, cols), top row first, and which of them is white; black is 0.

    Raises:
        InputError: If the file cannot be read, is no PGM, states more than `MOST_PIXELS` pixels, more shades than 256,
            or more pixels than it holds.
    """
    content = read_bytes(path, MOST_BYTES, f"a map's image has at most {MOST_PIXELS} pixels")
    header = _HEADER.match(content[:_HEADER_WITHIN])
    if header is None:
        raise InputError(f"{named(path)}: the map's image must be a PGM (P5 or P2), got {shown(content[:16])}...")
    cols, rows, white = (int(header[i]) for i in (2, 3, 4))
    if not 0 < white < 256 or cols * rows == 0:
        what = f"{cols} x {rows} with maximum {white}"
        raise InputError(f"{named(path)}: needs an 8-bit image that is not empty, got {what}")
    if cols * rows > MOST_PIXELS:
        raise InputError(f"{named(path)}: a map's image has at most {MOST_PIXELS} pixels, got {cols} x {rows}")
    if header[1] == b"P5":
        values = np.frombuffer(content, np.uint8, offset=header.end())[: cols * rows]
    else:
        pixels = _text_pixels(content, header.end(), white, path)
        values = np.fromiter((value for value, _ in zip(pixels, range(cols * rows), strict=False)), np.uint8)
    if len(values) != cols * rows:
        raise InputError(f"{named(path)}: the image is cut: needs {cols} x {rows} pixels, got {len(values)}")
    if values.max() > white:
        raise InputError(f"{named(path)}: shades are from 0 to the image's maximum {white}, got {values.max()}")
    return values.reshape(rows, cols), white


def _text_pixels(content: bytes, start: int, white: int, path: Path) -> Iterator[int]:
    for word in re.compile(rb"\S+").finditer(content, start):
        text = word[0]
        if len(text) > 3 or not text.isdigit() or int(text) > white:
            rule = f"shades are whole numbers from 0 to the image's maximum {white}"
            got = shown(text.decode("latin-1"))
            raise InputError(f"{named(path)}: {rule}, got {got}")
        yield int(text)
