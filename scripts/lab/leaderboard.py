"""Markdown of who follows best: one row a follower, with what was driven, when, and on what."""

from collections.abc import Mapping, Sequence
from typing import Any

from .cell_comparison import MEANS, ComparedCell

PAGE = """# Leaderboard

Written by `tagalong compare` on {date}, with tagalong {tagalong} on {cores} cores of
{processor} ({system}, Python {python}). Full world, the robot's own tracker, no SLAM.
Driven: {drives}. The same episodes for everybody.

{table}

Brackets: 95 % intervals. The last column is paired, tour by tour, with p of McNemar's exact test.

Your own follower enters with one module and one command ([how it is written](how-to/own-follower.md)):

<!-- only parsed: hours -->
```console
$ tagalong compare --suites {words} --followers {followers} my_module:Bold --leaderboard docs/leaderboard.md
```
"""


def leaderboard(
    cell: ComparedCell,
    followers: Sequence[str],
    suites: Mapping[str, int],
    machine: Mapping[str, Any],
    *,
    first_seed: int,
    date: str,
) -> str:
    """Return the page.

    Args:
        cell: All cells together.
        followers: The first is what the others are compared with.
        suites: Name -> episodes that each follower drove of it.
        machine: As of `describe_machine`.
        first_seed: Of each suite's episodes; the others follow it one by one.
        date: Of the comparison, year-month-day.
    """
    ranked = sorted(followers, key=lambda who: -cell.done[who].mean)
    drives = "; ".join(f"`{name}`, {n} tours, seeds {first_seed} to {first_seed + n - 1}" for name, n in suites.items())
    head = ("follower", "tours done", "ended in a contact", *MEANS.values(), f"tours more than {followers[0]}")
    rows = [
        (
            f"`{who}`",
            cell.done[who].text(),
            f"{cell.contacts[who]} of {cell.episodes}",
            *(cell.means[who][key].text() for key in MEANS),
            _lead(cell, who),
        )
        for who in ranked
    ]
    table = "\n".join(f"| {' | '.join(line)} |" for line in (head, ["---"] * len(head), *rows))
    words = " ".join(suites)
    return PAGE.format(date=date, **machine, drives=drives, table=table, words=words, followers=" ".join(followers))


def _lead(cell: ComparedCell, who: str) -> str:
    test = cell.paired.get(who)
    return "" if test is None else f"{test.difference:+.2f} [{test.low:+.2f}, {test.high:+.2f}], p {test.p:.2g}"
