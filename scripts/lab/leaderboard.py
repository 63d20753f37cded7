"""Markdown of who follows best: one row a follower, with what was driven, when, and on what."""

from collections.abc import Mapping, Sequence
from typing import Any

from .cell_comparison import TITLES, ComparedCell

COLUMNS = ("jerk_rms_mps3", "distance_error_rms_m", "personal_space_compliance")
MAP_COLUMNS = ("adnn_truth_to_map_m", "adnn_map_to_truth_m", "coverage")
PAGE = """# Leaderboard

Written by `tagalong compare` on {date}, with tagalong {tagalong} on {cores} of
{processor} ({system}, Python {python}). Full world, the robot's own tracker, {slam}.
Driven: {drives}. The same episodes for everybody.

{table}

Brackets: 95 % intervals. The last column is paired, tour by tour, with p of McNemar's exact test.

Your own follower enters with one module and [one command](how-to/own-follower.md). This table was written by
`tagalong compare --suites {words}{option} --followers {followers} --episodes {episodes}
--leaderboard docs/leaderboard.md`.
"""


def leaderboard(
    cell: ComparedCell,
    followers: Sequence[str],
    suites: Mapping[str, int],
    machine: Mapping[str, Any],
    *,
    episodes: int,
    first_seed: int,
    date: str,
    slam: str | None = None,
) -> str:
    """Return the page.

    Args:
        cell: All cells together.
        followers: The first is what the others are compared with.
        suites: Name -> episodes that each follower drove of it.
        machine: As of `describe_machine`.
        episodes: Of each cell of a suite.
        first_seed: Of each suite's episodes; the others follow it one by one.
        date: Of the comparison, year-month-day.
        slam: Engine that mapped meanwhile.
    """
    ranked = sorted(followers, key=lambda who: -cell.done[who].mean)
    drives = "; ".join(f"`{name}`, {n} tours, seeds {first_seed} to {first_seed + n - 1}" for name, n in suites.items())
    columns = COLUMNS if slam is None else (*MAP_COLUMNS, *COLUMNS)
    titles = [TITLES[key] for key in columns]
    head = ("follower", "tours done", "ended in a contact", *titles, f"tours more than {followers[0]}")
    rows = [
        (
            f"`{who}`",
            cell.done[who].text(),
            f"{cell.contacts(who)} of {cell.episodes}",
            *(cell.means[who][key].text(digits=3 if key in MAP_COLUMNS else 2) for key in columns),
            _lead(cell, who),
        )
        for who in ranked
    ]
    table = "\n".join(f"| {' | '.join(line)} |" for line in (head, ["---"] * len(head), *rows))
    words = " ".join(suites)
    mapped = {"slam": "no SLAM", "option": ""} if slam is None else {"slam": f"`{slam}`", "option": f" --slam {slam}"}
    cores = "1 core" if machine["cores"] == 1 else f"{machine['cores']} cores"
    told = {**machine, "cores": cores, **mapped, "date": date, "drives": drives, "table": table, "words": words}
    return PAGE.format(**told, followers=" ".join(followers), episodes=episodes)


def _lead(cell: ComparedCell, who: str) -> str:
    test = cell.paired.get(who)
    return "" if test is None else f"{test.difference:+.2f} [{test.low:+.2f}, {test.high:+.2f}], p {test.p:.2g}"
