"""A checksum of what a file holds, however it was packed: gzip and zip write a time into the same content."""

import bz2
import gzip
import hashlib
import lzma
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from ...slam.errors import InputError
from ...slam.files.npz import read_arrays

_PIECE = 1 << 20
_MOST_BYTES = 1 << 30
"""What a file may unpack to; the largest recording has a tenth of it."""
_DAMAGE = (
    OSError,
    EOFError,
    lzma.LZMAError,
    zlib.error,
    zipfile.BadZipFile,
    InputError,
    ValueError,
    RuntimeError,
    IndexError,
    NotImplementedError,
)


def content_digest(path: Path) -> str | None:
    """Return the SHA-256 of what a file holds; None if it cannot be read or unpacked.

    Of .gz, .xz and .bz2 that is what they unpack to, of a .zip its first member, of .npz its arrays by name, type and
    shape, of all others the file itself.
    """
    try:
        return _of_arrays(path) if path.suffix == ".npz" else _of_stream(path)
    except _DAMAGE:
        return None


def _of_stream(path: Path) -> str | None:
    digest, left = hashlib.sha256(), _MOST_BYTES
    with _unpacked(path) as file:
        while left > 0:
            piece = file.read(_PIECE)
            if not piece:
                return digest.hexdigest()
            digest.update(piece)
            left -= len(piece)
    return None


def _of_arrays(path: Path) -> str:
    digest = hashlib.sha256()
    for name, values in sorted(read_arrays(path).items()):
        digest.update(f"{name} {values.dtype.newbyteorder('<').str} {values.shape}\n".encode())
        digest.update(values.astype(values.dtype.newbyteorder("<")).tobytes())
    return digest.hexdigest()


@contextmanager
def _unpacked(path: Path) -> Iterator[IO[bytes]]:
    openers = {".gz": gzip.open, ".xz": lzma.open, ".bz2": bz2.open}
    if path.suffix == ".zip":
        with zipfile.ZipFile(path) as content, content.open(content.infolist()[0]) as file:
            yield file
    else:
        with openers.get(path.suffix, open)(path, "rb") as file:
            yield file
