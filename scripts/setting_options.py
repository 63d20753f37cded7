"""`--set PATH=VALUE`: fields of a configuration on the command line, for every command that has one."""

import argparse
import ast
from collections.abc import Sequence
from typing import Any

from ..slam.errors import InputError, shown


def add_settings(parser: argparse.ArgumentParser, what: str) -> None:
    """Declare `--set`, which may be repeated; `what` says whose fields it sets, with examples."""
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        dest="settings",
        help=f"{what}; may be repeated",
    )


def read_settings(words: Sequence[str]) -> dict[str, Any]:
    """Return name -> value of words NAME=VALUE: a value as Python writes it (50, 0.1, True, None, (1, 2)), else a text.

    Raises:
        InputError: If a word is none of these, or sets the seed, which is no field.
    """
    settings: dict[str, Any] = {}
    for word in words:
        name, equals, value = word.partition("=")
        if not equals or not all(part.isidentifier() for part in name.split(".")):
            raise InputError(f"--set needs NAME=VALUE, got {shown(word)}")
        if name == "seed":
            raise InputError("the seed has an option of its own: --seed")
        try:
            settings[name] = ast.literal_eval(value)
        except (ValueError, SyntaxError):
            settings[name] = value
    return settings
