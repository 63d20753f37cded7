"""Kinds of numbers on command lines: what is none of the kind is told by argparse in one line."""

import argparse
import math
from collections.abc import Callable

from ...slam.errors import InputError, shown

MOST = 1_000_000
"""Of things that take a second or more each: two weeks of them."""
MOST_CELLS = 10_000
"""Of an experiment, each of a minute or so and listed before the first is begun: a week of them."""
LARGEST_SEED = 2**32 - 1
"""What every generator takes."""
MOST_S = 86_400.0
"""A day of each drive."""


def at_least(least: int, most: int = MOST) -> Callable[[str], int]:
    """Return a `type` of argparse for whole numbers from `least` to `most`."""

    def whole(text: str) -> int:
        """Return the number that `text` is."""
        try:
            number = int(text)
        except ValueError:
            number = least - 1
        if number < least:
            raise argparse.ArgumentTypeError(f"must be a whole number of at least {least}, got {shown(text)}")
        if number > most:
            raise argparse.ArgumentTypeError(f"must be at most {most}, got {shown(text)}")
        return number

    return whole


def require_count(option: str, value: int, most: int, why: str, least: int = 1) -> None:
    """Check a number of things that take time or memory each.

    Args:
        option: Its name, as it stands on the command line.
        value: What was asked for.
        most: The largest number that is of use.
        why: The reason of that bound, as the error says it.
        least: The smallest.

    Raises:
        InputError: If it is less or more.
    """
    if value < least:
        raise InputError(f"{option} must be at least {least}, got {value}")
    if value > most:
        raise InputError(f"{option} must be at most {most} ({why}), got {shown(value)}")


def positive(text: str) -> float:
    """Return a time above 0, of a day at most [s]: a `type` of argparse."""
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not 0.0 < number <= MOST_S:
        raise argparse.ArgumentTypeError(f"must be a positive number of at most {MOST_S:g}, got {shown(text)}")
    return number
