"""Settings as a user writes them on the command line: NAME=VALUE."""

import ast
from collections.abc import Iterable
from typing import Any

from ...slam.errors import InputError


def settings_from(words: Iterable[str], option: str = "--set") -> dict[str, Any]:
    """Return the settings that words like "particles=50" or "local.insertion_voxel=0.1" say, by their names.

    A value is a number, True, False, None, or a list or tuple of such, as Python writes them; all else is text.

    Args:
        words: The words.
        option: Which option they were given to, for the error.

    Raises:
        InputError: If a word is none of that form.
    """
    settings: dict[str, Any] = {}
    for word in words:
        name, equals, value = word.partition("=")
        if not equals or not all(part.isidentifier() for part in name.split(".")):
            raise InputError(f"{option} needs NAME=VALUE, got {word!r}")
        try:
            settings[name] = ast.literal_eval(value)
        except (ValueError, SyntaxError):
            settings[name] = value
    return settings
