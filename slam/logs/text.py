"""Text files, plain or gzipped, read line by line and written to the byte."""

import gzip
import io
import os
import zlib
from collections.abc import Iterable, Iterator
from pathlib import Path

from ..errors import InputError
from ..files import replacing

_GZIP_MAGIC = b"\x1f\x8b"


def numbered_lines(path: str | os.PathLike[str], errors: str = "strict") -> Iterator[tuple[int, str]]:
    """Yield (line number from 1, line without its end) of a text file; gzip is found by content, not by name.

    Args:
        path: The file, in UTF-8, with or without the mark of it (BOM) that some editors put first.
        errors: What becomes of bytes that are none: "strict" or "replace", as `open` knows them.

    Raises:
        InputError: If the file is missing, is no text, or its gzip stream is cut or broken.
    """
    file = Path(path)
    try:
        with file.open("rb") as raw:
            zipped = raw.read(2) == _GZIP_MAGIC
        with gzip.open(file, "rb") if zipped else file.open("rb") as binary:
            text = io.TextIOWrapper(binary, encoding="utf-8-sig", errors=errors)  # type: ignore[arg-type]
            for number, line in enumerate(text, start=1):
                yield number, line.rstrip("\r\n")
    except UnicodeDecodeError as error:
        raise InputError(f"{file}: expected a text file (UTF-8), got bytes that are none") from error
    except (EOFError, zlib.error, gzip.BadGzipFile) as error:
        raise InputError(f"{file}: the gzip stream is cut or broken ({error})") from error
    except OSError as error:
        raise InputError(f"{file}: cannot be read ({error.strerror or error})") from error


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
            raise InputError(f"{where}: expected {what}, got {word!r}") from None
    return result
