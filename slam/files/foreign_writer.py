"""Lets a library write a file by itself and learns what the disk refuses, which the library may not tell."""

import os
import threading
from pathlib import Path

_DESCRIPTORS = Path("/dev/fd")
"""Where the system gives an open pipe the name of a file; Windows has none."""
_PIECE = 1 << 16


class ForeignWriter:
    """A name that a library is given to write to, in order and without going back, and the file where it arrives.

    The name is that of a pipe, which takes everything, so that the library cannot come to wait for a disk that is full;
    what comes out is written into the file. Where pipes have no names, it is the file's own.

    Args:
        file: Where it arrives.

    Attributes:
        name: What the library is told to write to, at once and once; then call `begun`.

    Raises:
        OSError: If `file` cannot be opened.
    """

    def __init__(self, file: Path) -> None:
        self.name = file
        self._refused: OSError | None = None
        self._thread: threading.Thread | None = None
        if not _DESCRIPTORS.is_dir():
            return
        target = os.open(file, os.O_WRONLY | os.O_TRUNC)
        source, self._end = os.pipe()
        self.name = _DESCRIPTORS / str(self._end)
        self._thread = threading.Thread(target=self._pass_on, args=(source, target), daemon=True)
        self._thread.start()

    def begun(self) -> None:
        """Leave the pipe to the library, which has opened it: it ends when that closes it."""
        if self._thread is not None:
            os.close(self._end)

    def close(self) -> None:
        """Wait for the last piece; the library has closed its end.

        Raises:
            OSError: What the disk refused, if it did.
        """
        if self._thread is not None:
            self._thread.join()
        if self._refused is not None:
            raise self._refused

    def _pass_on(self, source: int, target: int) -> None:
        try:
            while piece := os.read(source, _PIECE):
                self._write(target, piece)
        finally:
            os.close(source)
            os.close(target)

    def _write(self, target: int, piece: bytes) -> None:
        """Write a piece; after the first that was refused, none."""
        try:
            while piece and self._refused is None:
                piece = piece[os.write(target, piece) :]
        except OSError as error:
            self._refused = error
