"""What the commands declare: every option of every command line, found by walking the parsers."""

import argparse
from collections.abc import Callable, Iterator
from typing import Any

from tagalong.scripts.cli import make_parser


def declared_options() -> Iterator[tuple[tuple[str, ...], argparse.Action]]:
    """Yield the words of each command and each option that follows on them."""
    yield from _below(make_parser(), ())


def _below(parser: argparse.ArgumentParser, command: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], Any]]:
    for action in parser._actions:  # argparse has no other way to ask
        if isinstance(action, argparse._SubParsersAction):
            declare: Callable[..., None] | None = getattr(action, "declare", None)
            for name, chosen in action.choices.items():
                if declare is not None:
                    declare(name, chosen)
                yield from _below(chosen, (*command, name))
        elif action.option_strings:
            yield command, action


def takes_numbers(kind: Any) -> bool:
    """Return whether a `type` of argparse makes a number of some word."""
    for word in ("0", "1", "50"):
        try:
            return isinstance(kind(word), int | float)
        except (argparse.ArgumentTypeError, TypeError, ValueError):
            continue
    return False
