"""Copies a CARMEN log line by line, with some ranges of its laser lines taken out; however long it is."""

import gzip
import os
import re
import zlib
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from typing import IO

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
Removal = Callable[[str, LaserScan, Array, NDArray[np.intp], int], NDArray[np.bool_]]
"""Takes the kind of a line, its scan, T_odom_robot (3,), which range each beam is, and how many ranges there are.

Returns (n,) which of the ranges to take out."""

_LASERS = (b"FLASER", b"ROBOTLASER1")
_MOST_BYTES = 1 << 40
_GZIP_MAGIC = b"\x1f\x8b"
_NOTHING = b"0.0"  # "no measurement", as simulators and filters write it
_SPACE = re.compile(rb"(\s+)")


def copy_carmen(source: str | os.PathLike[str], target: str | os.PathLike[str], removal: Removal) -> None:
    """Copy a log to `target`, whole or not at all; ranges that `removal` says become 0.0, "no measurement".

    All else stays as it is, byte for byte. A target whose name ends in .gz is compressed. The log is read twice: what
    FLASER lines write for "no return" is known by the largest range of all.

    Args:
        source: The log, plain or gzipped.
        target: Where the copy goes.
        removal: Asked for each FLASER and ROBOTLASER1 line, in order.

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
        for number, line in _numbered(source):
            words = line.split()
            with _line_named(source, number, words):
                if words and words[0] in _LASERS:
                    line = _without(line, words, offset, limit, removal)
            out.write(line)


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


def _without(line: bytes, words: list[bytes], offset: float, limit: float, removal: Removal) -> bytes:
    """Return a laser line with the ranges taken out that `removal` says; arguments as of `scan_of`."""
    record = laser_record(words)
    count, odometry = len(record.ranges), np.array(record.robot)
    mount = np.round(between(odometry, np.array(record.laser)), 4) if record.max_range is not None else (offset, 0, 0)
    x, y, theta = (float(value) for value in mount)
    scan, order = scan_of(record, (x, y, theta), limit)
    removed = removal(words[0].decode("ascii"), scan, odometry, order, count)
    if not removed.any():
        return line
    parts = _SPACE.split(line)  # words and what is between them, in turns
    first = 2 * first_reading(words) + (0 if parts[0] else 2)
    for beam in np.flatnonzero(removed).tolist():
        parts[first + 2 * beam] = _NOTHING
    return b"".join(parts)


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
