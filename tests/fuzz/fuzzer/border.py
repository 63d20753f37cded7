"""A border: a public door through which input from outside comes in, how to make such input, and what is a sane result.

An input is plain data (None, bool, int, float, str, bytes, lists and dicts of them), so that it can be written to a
file and sent again.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from numpy.random import Generator

Input = Any
Call = Callable[[Input, Path], Any]


class InsaneError(AssertionError):
    """A result that no hostile input may reach: said by the check of a border."""


def always_sane(result: Any) -> None:
    """Accept every result: what counts is that there is one."""


def nothing_to_warm() -> None:
    """Make nothing ready."""


@dataclass(frozen=True, kw_only=True)
class Border:
    """One door.

    Attributes:
        name: "area.door", e.g. "logs.carmen".
        make: Input from a source of draws; the same draws, the same bytes.
        call: Sends an input through the door; the folder is empty but for what earlier inputs of this door left there.
        sane: Raises `InsaneError` for a result that makes no sense.
        file: Name that a refusal must say, as it is the file's; "" where the input is no file.
        reserved_mb: Address space that a library may ask for there without using it [MB]; what is used stays bounded.
        ms: What an input costs [ms], measured once: dear doors get fewer inputs.
        refusals: Kinds of errors, beside InputError and MissingExtraError, that are the promised ones here.
    """

    name: str
    make: Callable[[Generator], Input]
    call: Call
    sane: Callable[[Any], None] = always_sane
    file: str = ""
    reserved_mb: int = 256
    ms: float = 1.0
    refusals: tuple[type[BaseException], ...] = ()

    @property
    def area(self) -> str:
        """The first part of the name: borders of an area are made ready together."""
        return self.name.split(".")[0]


@dataclass(frozen=True)
class Area:
    """Borders that need the same things made ready."""

    borders: tuple[Border, ...]
    warm: Callable[[], None] = nothing_to_warm


def require(condition: object, what: str) -> None:
    """Raise `InsaneError` that says `what` unless the condition holds."""
    if not condition:
        raise InsaneError(what)
