"""Files that are read: regular ones only, of a bounded size; what is wrong with one is told in a line with its name."""

import errno
import json
import math
import os
import stat
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from pathlib import Path
from typing import Any, BinaryIO, Concatenate, ParamSpec, TypeVar

from ..errors import InputError, one_line, shown

Source = str | os.PathLike[str]
Rest = ParamSpec("Rest")
Result = TypeVar("Result")

MIB = 1 << 20
MOST_JSON = 16 * MIB
"""Bytes of a JSON file: the results of a whole experiment take less than one MiB; parsed, it takes 20 times that."""
_KINDS = (
    (stat.S_ISDIR, "a folder"),
    (stat.S_ISFIFO, "a pipe"),
    (stat.S_ISSOCK, "a socket"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
)


def named(path: Source) -> str:
    """Return a path as errors name it: whole, but for names that no system takes."""
    return one_line(os.fspath(path), 400)


@contextmanager
def naming(where: str) -> Iterator[None]:
    """Let each error that comes of what is read at a place begin with the place, unless it names it already."""
    try:
        yield
    except InputError as error:
        if where in str(error):
            raise
        raise InputError(f"{where}: {error}") from error


def names_file(read: Callable[Concatenate[Source, Rest], Result]) -> Callable[Concatenate[Source, Rest], Result]:
    """Return a reader of files, whose first argument is a path, so that each of its errors names the file.

    A reader names it where it looks at lines; what is made of their numbers in the end does not know it.
    """

    @wraps(read)
    def reader(path: Source, *args: Rest.args, **options: Rest.kwargs) -> Result:
        """Read `path`, and say which file it was that could not be read."""
        with naming(named(path)):
            return read(path, *args, **options)

    return reader


def checked_name(path: Source) -> Path:
    """Return `path`, if a file may have such a name at all.

    Raises:
        InputError: If it holds a zero byte, or signs that no file system takes.
    """
    try:
        encoded = os.fsencode(path)
    except UnicodeError:
        encoded = b"\0"
    if b"\0" in encoded:
        raise InputError(f"{named(path)}: is no name that a file can have")
    return Path(os.fsdecode(encoded))


def kind_of_file(mode: int) -> str:
    """Return what something is that is no regular file ("a folder", "a pipe"), by its mode; "" for a regular file."""
    return "" if stat.S_ISREG(mode) else next((name for test, name in _KINDS if test(mode)), "no regular file")


@contextmanager
def opened(path: Source, most_bytes: int, why: str) -> Iterator[BinaryIO]:
    """Open a regular file for reading; nothing else is waited for or touched: no device, no pipe, no folder.

    Args:
        path: The file; links are followed.
        most_bytes: The largest size that is read.
        why: What has at most this size, as the error says: "a log has at most 512 MiB: cut it into parts".

    Raises:
        InputError: If there is no such file, it is none, it is too large, or it cannot be read: also for an `OSError`
            that is raised while it is open.
    """
    try:
        with open(_handle(path), "rb") as file:
            found = os.fstat(file.fileno())
            _require_regular(path, found.st_mode)
            if found.st_size > most_bytes:
                raise InputError(f"{named(path)}: is too large ({found.st_size} bytes); {why}")
            yield file
    except OSError as error:
        raise unreadable(path, error) from error


def require_regular(path: Source) -> None:
    """Make sure that `path` is a regular file, before a library opens it by its name.

    Raises:
        InputError: If it is none, or not there.
    """
    try:
        _require_regular(path, checked_name(path).stat().st_mode)
    except OSError as error:
        raise unreadable(path, error) from error


def _require_regular(path: Source, mode: int) -> None:
    if kind_of_file(mode):
        raise InputError(f"{named(path)}: is {kind_of_file(mode)}, where a file is needed")


def _handle(path: Source) -> int:
    """Return an open file, having asked what it is: only to open a device may already do something."""
    require_regular(path)
    # what stands there may have been exchanged for a pipe since: that must not be waited for
    flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_BINARY", 0)
    return os.open(path, flags)


def unreadable(path: Source, error: OSError) -> InputError:
    """Return the error for a file that the system does not give."""
    why = "no such file" if error.errno == errno.ENOENT else error.strerror or error
    return InputError(f"{named(path)}: cannot be read ({why})")


def read_bytes(path: Source, most_bytes: int, why: str) -> bytes:
    """Return the content of a regular file; arguments and errors as of `opened`."""
    with opened(path, most_bytes, why) as file:
        content = file.read(most_bytes + 1)
    if len(content) > most_bytes:  # it grew since
        raise InputError(f"{named(path)}: is too large; {why}")
    return content


def read_text(path: Source, most_bytes: int, why: str) -> str:
    """Return the text (UTF-8) in a regular file; arguments and errors as of `opened`, also where it is no text."""
    try:
        return read_bytes(path, most_bytes, why).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"{named(path)}: expected a text file (UTF-8), got bytes that are none") from error


def read_json(path: Source, most_bytes: int = MOST_JSON) -> Any:
    """Return what a JSON file holds: dicts, lists, texts, numbers, booleans, None.

    Raises:
        InputError: Naming the file, and the line and column where it goes wrong: if it cannot be read, is larger than
            `most_bytes`, is no JSON, is nested too deeply, or holds NaN, infinity or a number of thousands of digits.
    """
    return parse_json(read_text(path, most_bytes, f"a JSON file has at most {most_bytes} bytes"), named(path))


def parse_json(text: str, where: str) -> Any:
    """Return what a JSON text holds; `where` it stands is named in errors, which are as of `read_json`."""
    try:
        return json.loads(text, parse_constant=_number, parse_float=_number)
    except json.JSONDecodeError as error:
        raise InputError(f"{where}:{error.lineno}:{error.colno}: no JSON ({error.msg})") from error
    except RecursionError as error:
        raise InputError(f"{where}: is nested too deeply for JSON that this program reads") from error
    except ValueError as error:  # Python turns no text of more than 4,300 digits into a whole number
        raise InputError(f"{where}: no JSON ({one_line(str(error), 200)})") from error


def _number(word: str) -> float:
    value = float(word)
    if not math.isfinite(value):
        raise ValueError(f"{shown(word)} is no finite number")
    return value
