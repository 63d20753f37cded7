"""Text files, plain or gzipped, read line by line and written to the byte."""

import codecs
import gzip
import os
import zlib
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import IO

from ..errors import InputError, shown
from ..files.input import MIB, named, opened
from ..files.output import replacing

MOST_BYTES = 512 * MIB
"""Of a text file, unpacked: half an hour of a laser of 1081 beams at 40 Hz, or 14 hours of one of 180 beams at 10."""
MOST_LINES = 5_000_000
"""Of a text file: 14 hours of a hundred lines a second."""
MOST_LINE = MIB
"""Bytes of a line: a hundred thousand beams, or as many cells of a map."""
MOST_POSES = 1_000_000
"""Lines of a file with one pose, or one relation between two of them, a line: 28 hours at 10 Hz."""
LARGEST = 1e18
"""Size of a number in a table: times since 1970 in nanoseconds; sums of its squares are finite."""
_DIGITS = 9
"""Of a count: more of anything than these can say has no room in memory."""
_GZIP_MAGIC = b"\x1f\x8b"
_BLOCK = 1 << 16
_COUNTED_FROM = 8 * MIB


def numbered_lines(
    path: str | os.PathLike[str], errors: str = "strict", most_lines: int = MOST_LINES, most_bytes: int = MOST_BYTES
) -> Iterator[tuple[int, str]]:
    """Yield (line number from 1, line without its end) of a text file; gzip is found by content, not by name.

    Args:
        path: The file, in UTF-8, with or without the mark of it (BOM) that some editors put first.
        errors: What becomes of bytes that are none: "strict" or "replace", as `open` knows them.
        most_lines: How many lines are read.
        most_bytes: How many bytes are read, unpacked.

    Raises:
        InputError: If the file is missing, no regular file or no text, its gzip stream is cut or broken, or it is
            longer than its bounds, or has a line longer than `MOST_LINE`.
    """
    for number, line in numbered_bytes(path, most_lines, most_bytes):
        try:
            yield number, line.decode("utf-8", errors)
        except UnicodeDecodeError as error:
            raise InputError(f"{Path(path)}:{number}: expected a text file (UTF-8), got bytes that are none") from error


def numbered_bytes(
    path: str | os.PathLike[str], most_lines: int = MOST_LINES, most_bytes: int = MOST_BYTES
) -> Iterator[tuple[int, bytes]]:
    """Yield (line number from 1, line without its end) as bytes; arguments and errors as of `numbered_lines`."""
    with opened(path, most_bytes, f"a text file has at most {most_bytes} bytes: cut it into parts") as raw:
        zipped = raw.read(2) == _GZIP_MAGIC
        raw.seek(0)
        try:
            blocks = _bounded(gzip.GzipFile(fileobj=raw), path, most_bytes) if zipped else _blocks(raw)
            for number, line in enumerate(_lines(blocks, path), start=1):
                if number > most_lines:
                    raise InputError(f"{named(path)}: has more than {most_lines} lines: cut it into parts")
                yield number, line
        except (EOFError, zlib.error, gzip.BadGzipFile) as error:
            raise InputError(f"{named(path)}: the gzip stream is cut or broken ({error})") from error


def _blocks(stream: IO[bytes] | gzip.GzipFile) -> Iterator[bytes]:
    while block := stream.read(_BLOCK):
        yield block


def _bounded(stream: gzip.GzipFile, path: str | os.PathLike[str], most_bytes: int) -> Iterator[bytes]:
    """Yield blocks of an unpacked stream; one that gets long is measured to its end before its reader goes on.

    To unpack is fast, to read what comes out is not: gigabytes of good lines must not be read before they are refused.
    """
    got = 0
    for block in _blocks(stream):
        if got <= _COUNTED_FROM < got + len(block):
            _require_bounded(path, most_bytes)
        got += len(block)
        if got > most_bytes:
            raise InputError(_too_long(path, most_bytes))
        yield block


def _require_bounded(path: str | os.PathLike[str], most_bytes: int) -> None:
    with opened(path, most_bytes, "") as raw:
        again, got = gzip.GzipFile(fileobj=raw), 0
        while block := again.read(MIB):
            got += len(block)
            if got > most_bytes:
                raise InputError(_too_long(path, most_bytes))


def _too_long(path: str | os.PathLike[str], most_bytes: int) -> str:
    return f"{named(path)}: unpacks to more than {most_bytes} bytes, the most that a text file has: cut it into parts"


def _lines(blocks: Iterator[bytes], path: str | os.PathLike[str]) -> Iterator[bytes]:
    r"""Yield the lines of a stream of bytes, which end in \n, \r\n or \r; a first mark of UTF-8 is taken off."""
    rest, first, after_return = b"", True, False
    for block in blocks:
        if first:
            block, first = block.removeprefix(codecs.BOM_UTF8), False
        if after_return:  # the line has ended already, with the block before
            block = block.removeprefix(b"\n")
        after_return = block.endswith(b"\r")
        *whole, rest = (rest + block.replace(b"\r\n", b"\n").replace(b"\r", b"\n")).split(b"\n")
        if max(map(len, (*whole, rest))) > MOST_LINE:
            raise InputError(f"{named(path)}: has a line of more than {MOST_LINE} bytes")
        yield from whole
    if rest:
        yield rest


def first_line(path: str | os.PathLike[str]) -> str:
    """Return the first line that says anything, "" if none does, to tell by what the file is; in any encoding.

    Raises:
        InputError: If the file cannot be read.
    """
    return next((line for _, line in numbered_lines(path, errors="replace") if line.strip()), "")


def write_lines(path: str | os.PathLike[str], lines: Iterable[str]) -> None:
    """Write `lines` with `\\n` ends to `path`, whole or not at all; gzipped where the name ends in .gz.

    The same lines give the same bytes at any time and under any name: no time and no name go into the gzip header.
    """
    with replacing(path) as temporary, temporary.open("wb") as raw:
        if Path(path).suffix == ".gz":
            with gzip.GzipFile(filename="", mode="wb", fileobj=raw, mtime=0, compresslevel=6) as zipped:
                zipped.writelines(f"{line}\n".encode() for line in lines)
        else:
            raw.writelines(f"{line}\n".encode() for line in lines)


def numbers(words: Iterable[str], where: str, what: str) -> list[float]:
    """Return `words` as floats; the error names `where` (file and line) and `what` was expected."""
    result = []
    for word in words:
        try:
            result.append(float(word))
        except ValueError:
            raise InputError(f"{where}: expected {what}, got {shown(word)}") from None
    return result


def finite_numbers(words: list[str], where: str) -> list[float]:
    """Return `words` as floats of at most `LARGEST`; the error names `where` (file and line) and shows them."""
    result = numbers(words, where, "a number")
    if not all(abs(value) <= LARGEST for value in result):
        raise InputError(f"{where}: expected finite numbers of at most {LARGEST:g}, got {shown(' '.join(words))}")
    return result


def whole_number(word: str | bytes) -> int | None:
    """Return a count as it is written in digits, or None where it is none, or has more than nine."""
    return int(word) if len(word) <= _DIGITS and word.isdigit() and word.isascii() else None
