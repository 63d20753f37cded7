"""Copies a CARMEN log line by line, with some ranges of its laser lines taken out; however long it is."""

import gzip
import os
import re
import zlib
from collections import deque
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from typing import IO, Protocol

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..files.input import named, naming, opened
from ..files.output import replacing
from ..geometry import between
from ..scan import LaserScan
from .carmen import first_reading, front_offset, largest_range, laser_record, no_return_from, scan_of
from .text import MOST_LINE

Array = NDArray[np.float64]
_LASERS = (b"FLASER", b"ROBOTLASER1")
_MOST_BYTES = 1 << 40
_GZIP_MAGIC = b"\x1f\x8b"
_NOTHING = b"0.0"  # "no measurement", as simulators and filters write it
_SPACE = re.compile(rb"(\s+)")


@dataclass(eq=False)
class LaserLine:
    """A line of a log; `removed` says, sooner or later, which of its ranges to take out.

    Attributes:
        text: The line with its end.
        kind: Its first word.
        scan: The scan that it says.
        odometry: (3,) T_odom_robot.
        order: (N,) which range each beam of the scan is.
        readings: How many ranges there are.
        removed: (readings,) which of them to take out; None: it is not known yet.
    """

    text: bytes
    kind: str
    scan: LaserScan
    odometry: Array
    order: NDArray[np.intp]
    readings: int
    removed: NDArray[np.bool_] | None = None

    def written(self) -> bytes:
        """Return the line without what is to be taken out."""
        if self.removed is None or not self.removed.any():
            return self.text
        parts = _SPACE.split(self.text)  # words and what is between them, in turns
        first = 2 * first_reading(self.text.split()) + (0 if parts[0] else 2)
        for beam in np.flatnonzero(self.removed).tolist():
            parts[first + 2 * beam] = _NOTHING
        return b"".join(parts)


class Removal(Protocol):
    """Says what to take out of laser lines, now or some lines later."""

    def take(self, line: LaserLine) -> None:
        """Take the next laser line; write `removed` into those of which it is known."""
        ...

    def rest(self) -> None:
        """Write it into all lines that still wait: there are no more."""
        ...


def copy_carmen(source: str | os.PathLike[str], target: str | os.PathLike[str], removal: Removal) -> None:
    """Copy a log to `target`, whole or not at all; ranges that `removal` says become 0.0, "no measurement".

    Lines are held back while it is not known what to take out of one before them.

    All else stays as it is, byte for byte. A target whose name ends in .gz is compressed. The log is read twice: what
    FLASER lines write for "no return" is known by the largest range of all.

    Args:
        source: The log, plain or gzipped.
        target: Where the copy goes.
        removal: Takes each FLASER and ROBOTLASER1 line, in order.

    Raises:
        InputError: If the log cannot be read, a line is damaged (with its number), or no scan is in it.
    """
    largest, offset, scans = 0.0, 0.0, 0
    for number, line in _numbered(source):
        words = line.split(maxsplit=3)
        with _line_named(source, number, words):
            found = front_offset(words)
            offset = offset if found is None else found
            scans += bool(words and words[0] in _LASERS)
            if words and words[0] == b"FLASER":
                largest = max(largest, largest_range(laser_record(line.split())))
    if not scans:
        raise InputError(f"{named(source)}: no laser scan found; expected lines beginning with FLASER or ROBOTLASER1")
    limit = no_return_from(largest)
    with ExitStack() as stack:
        raw = stack.enter_context(stack.enter_context(replacing(target)).open("wb"))
        zipped = os.fspath(target).endswith(".gz")
        out: IO[bytes] | gzip.GzipFile = raw
        if zipped:
            out = stack.enter_context(gzip.GzipFile(filename="", mode="wb", fileobj=raw, mtime=0, compresslevel=6))
        waiting: deque[bytes | LaserLine] = deque()
        for number, line in _numbered(source):
            words = line.split()
            waiting.append(line)
            with _line_named(source, number, words):
                if words and words[0] in _LASERS:
                    laser = _laser_line(line, words, offset, limit)
                    waiting[-1] = laser
                    removal.take(laser)
            _write_known(waiting, out)
        removal.rest()
        _write_known(waiting, out)


def _write_known(waiting: deque[bytes | LaserLine], out: IO[bytes] | gzip.GzipFile) -> None:
    """Write the first of the lines that are `waiting`, up to one of which it is not known what to take out."""
    while waiting:
        line = waiting[0]
        if isinstance(line, LaserLine):
            if line.removed is None:
                return
            line = line.written()
        out.write(line)
        waiting.popleft()


@contextmanager
def _line_named(source: str | os.PathLike[str], number: int, words: list[bytes]) -> Iterator[None]:
    """Name the line where it is damaged."""
    where = f"{named(source)}, line {number}: {words[0].decode('latin-1')}" if words else named(source)
    try:
        with naming(where):
            yield
    except InputError:
        raise
    except ValueError as error:
        raise InputError(f"{where}: {error}") from error


def _laser_line(line: bytes, words: list[bytes], offset: float, limit: float) -> LaserLine:
    """Read a laser line; arguments as of `scan_of`."""
    record = laser_record(words)
    count, odometry = len(record.ranges), np.array(record.robot)
    mount = np.round(between(odometry, np.array(record.laser)), 4) if record.max_range is not None else (offset, 0, 0)
    x, y, theta = (float(value) for value in mount)
    scan, order = scan_of(record, (x, y, theta), limit)
    return LaserLine(line, words[0].decode("ascii"), scan, odometry, order, count)


def _numbered(path: str | os.PathLike[str]) -> Iterator[tuple[int, bytes]]:
    """Yield (line number from 1, line with its end) of a file, plain or gzipped."""
    with opened(path, _MOST_BYTES, "a log has at most 1 TiB") as raw:
        zipped = raw.read(2) == _GZIP_MAGIC
        raw.seek(0)
        stream: IO[bytes] | gzip.GzipFile = gzip.GzipFile(fileobj=raw) if zipped else raw
        number = 0
        try:
            while line := stream.readline(MOST_LINE + 1):
                number += 1
                if len(line) > MOST_LINE:
                    raise InputError(f"{named(path)}: has a line of more than {MOST_LINE} bytes")
                yield number, line
        except (EOFError, zlib.error, gzip.BadGzipFile) as error:
            raise InputError(f"{named(path)}: the gzip stream is cut or broken ({error})") from error
