"""Kinds of numbers on command lines: what is none of the kind is told by argparse in one line.

Every option that is a number has one of these as its `type`, so that none is without bounds; a test holds that.
"""

import argparse
import math
from collections.abc import Callable

from ...slam.errors import shown

MOST = 1_000_000
"""Of things that take a second or more each: two weeks of them."""
MOST_CELLS = 10_000
"""Of an experiment, each of a minute or so and listed before the first is begun: a week of them."""
MOST_EPISODES = 100_000
"""Each takes some seconds: days of them."""
LARGEST_SEED = 2**32 - 1
"""What every generator takes."""
MOST_S = 86_400.0
"""A day of each drive."""
HIGHEST_M = 100.0
"""Where a sensor is mounted above the floor, or a distance that is told of one."""


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


random_seed = at_least(0, LARGEST_SEED)
"""A `type` of argparse for what random draws are made from."""


def within(least: float, most: float) -> Callable[[str], float]:
    """Return a `type` of argparse for numbers from `least` to `most`."""

    def real(text: str) -> float:
        """Return the number that `text` is."""
        number = _number(text)
        if not least <= number <= most:
            raise argparse.ArgumentTypeError(f"must be a number within {least:.10g} .. {most:.10g}, got {shown(text)}")
        return number

    return real


def positive(text: str) -> float:
    """Return a time above 0, of a day at most [s]: a `type` of argparse."""
    number = _number(text)
    if not 0.0 < number <= MOST_S:
        raise argparse.ArgumentTypeError(f"must be a positive number of at most {MOST_S:g}, got {shown(text)}")
    return number


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return math.nan
