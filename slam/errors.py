"""Errors that a user can cause; the command line prints them in one line and exits with 2."""

import os
import reprlib
from typing import Any

MOST_SHOWN = 80
"""Characters of a value in an error: enough to find it in a line, and two of them fit on a screen."""


class InputError(ValueError):
    """Bad input from outside (file, argument, configuration). The message names the thing, the rule, what was got."""


class UnwritableError(InputError):
    """A file or a folder cannot be written: by its name, its folder, or the disk."""


class WorkerError(RuntimeError):
    """A worker process is gone, or gives no sign of life. The message says which one, and how it ended."""


class MissingExtraError(ImportError):
    """An optional dependency is needed that is not installed.

    Args:
        what: The feature that needs it, e.g. "figures".
        extra: The name of the extra in pyproject.toml that brings it, e.g. "viz".
    """

    def __init__(self, what: str, extra: str) -> None:
        super().__init__(f'{what} need the extra "{extra}": pip install "tagalong[{extra}]"')
        self.what, self.extra = what, extra

    def __reduce__(self) -> tuple[object, ...]:
        """Come whole through a pipe between processes."""
        return type(self), (self.what, self.extra), self.__dict__


def unknown_name(kind: str, name: object, known: "list[str] | tuple[str, ...]") -> InputError:
    """Return the error for a name that is not in a table, listing those that are."""
    return InputError(f"unknown {kind} {shown(name)}; {kind}s: {', '.join(sorted(known))}")


def shown(value: object, most: int = MOST_SHOWN) -> str:
    """Return `value` for an error: on one line, control characters escaped, the middle left out where it is long.

    Args:
        value: What was got. A path is shown plainly, everything else as Python writes it ('text', [1, 2]).
        most: Number of characters that the result may have.
    """
    if isinstance(value, os.PathLike):
        return one_line(os.fspath(value), most)
    return one_line(_Short(most).repr(value), most)


def one_line(text: str | bytes, most: int) -> str:
    """Return `text` in at most `most` characters, none of them a control character: the middle is left out.

    Both ends of a message count: who speaks stands first, what was wrong often last.
    """
    plain = _cut(text if isinstance(text, str) else os.fsdecode(text), most)
    if not plain.isprintable():
        escaped = (c if c.isprintable() else c.encode("unicode_escape", "surrogatepass").decode() for c in plain)
        plain = _cut("".join(escaped), most)
    return plain


def _cut(text: str, most: int) -> str:
    if len(text) <= most:
        return text
    head = (most - 5) * 2 // 3
    return f"{text[:head]} ... {text[len(text) - (most - 5 - head) :]}"


class _Short(reprlib.Repr):
    """Writes long and deep things without writing them whole first."""

    def __init__(self, most: int) -> None:
        super().__init__()
        self.maxstring = self.maxother = self.maxlong = most
        self.maxlist = self.maxtuple = self.maxdict = self.maxset = 8

    def repr_int(self, x: int, level: int) -> str:
        """Return a whole number; Python refuses to write one of more than 4,300 digits."""
        return super().repr_int(x, level) if abs(x).bit_length() < 10_000 else f"a number of {x.bit_length()} bits"

    def repr_instance(self, x: Any, level: int) -> str:
        """Return what an object says of itself, on one line."""
        return " ".join(super().repr_instance(x, level).split())
