"""`--set NAME=VALUE`: settings on the command line, for every command that has a configuration."""

import argparse
import ast
from collections.abc import Iterable
from typing import Any

from ...slam.errors import InputError, shown


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


def read_settings(words: Iterable[str], option: str = "--set") -> dict[str, Any]:
    """Return name -> value of words such as "particles=50" or "local.insertion_voxel=0.1".

    A value is a number, True, False, None, or a list or tuple of such, as Python writes them; all else is text.

    Args:
        words: The words.
        option: Which option they were given to, for the error.

    Raises:
        InputError: If a word is none of that form, or `--set` sets the seed, which has an option of its own.
    """
    settings: dict[str, Any] = {}
    for word in words:
        name, equals, value = word.partition("=")
        if not equals or not all(part.isidentifier() for part in name.split(".")):
            raise InputError(f"{option} needs NAME=VALUE, got {shown(word)}")
        if name == "seed" and option == "--set":
            raise InputError("the seed has an option of its own: --seed")
        try:
            settings[name] = ast.literal_eval(value)
        except (ValueError, SyntaxError):
            settings[name] = value
    return settings
