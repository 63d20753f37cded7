"""`tagalong compare`: followers on suites, cell by cell, on the same episodes; one table, with intervals."""

import argparse
import datetime
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from tqdm import tqdm

from ...agents import make_follower
from ...envs.suites import FIRST_SEED, SUITES, suite
from ...slam.errors import InputError, shown
from ...slam.files.output import made_folder, write_json, write_text
from ...slam.processes.crew import require_workers
from ..console.arguments import MOST_EPISODES, at_least
from ..console.tables import format_table
from ..figures.plots import require_matplotlib
from ..lab.backends import runner
from ..lab.cell_comparison import ComparedCell, compare_cells, report
from ..lab.driven_episodes import episode_row, finished_rows, scenario_environment
from ..lab.hardware import describe_machine
from ..lab.leaderboard import leaderboard

EPILOG = """\
The first of --followers is what the others are compared with: the share of tours done, paired episode by episode
(McNemar's exact test, corrected for the number of cells after Holm), and all other figures (Wilcoxon's signed ranks).
Episodes are driven with the tracker. Without --slam nothing maps; with it the robot maps as it follows, and its map is
compared with the true building (ADNN both ways), its poses with the true ones, and the floor counted that its laser saw
from 4.6 m or nearer. Every finished episode is a line of episodes.jsonl at once, and they are sorted at the end; the
same command goes on where it was stopped, and --jobs decides nothing but the time.

writes into DIR: episodes.jsonl, results.json, report.md, with --plot trade_off.png; and the leaderboard where
--leaderboard says. A follower of your own is one more name: what the others drove into DIR is not driven again.

examples:
  tagalong compare --suites office floor_plan --followers pid mppi mapper --slam cartographer --out out/maps
  tagalong compare --suites hard-v2 --followers pid learned reinforced reinforced-alone --episodes 100 --jobs 2
  tagalong compare --followers pid mppi my_module:Bold --leaderboard docs/leaderboard.md
  tagalong compare --quick
"""
QUICK = 2
"""Episodes of each cell with --quick."""
MAPPERS = ("cartographer", "gmapping")
EVERYBODY = ("pid", "plain_pid", "pure_pursuit", "dwa", "mppi", "learned", "reinforced-alone", "reinforced")
"""Who is compared if nobody is named: those who need nothing but a leader."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.epilog = EPILOG
    names = f"as for `tagalong evaluate` (default: {', '.join(EVERYBODY)})"
    parser.add_argument("--followers", nargs="+", default=list(EVERYBODY), metavar="WHO", help=names)
    parser.add_argument("--suites", nargs="+", choices=sorted(SUITES), default=["hard-v2"], metavar="SUITE")
    parser.add_argument(
        "--episodes", type=at_least(1, MOST_EPISODES), default=20, metavar="N", help="of each cell (%(default)s)"
    )
    parser.add_argument("--slam", choices=MAPPERS, metavar="ENGINE", help=f"map meanwhile: {' or '.join(MAPPERS)}")
    parser.add_argument("--plot", action="store_true", help="draw what costs what (extra viz)")
    parser.add_argument("--quick", action="store_true", help=f"{QUICK} episodes of each cell")
    parser.add_argument(
        "--leaderboard", type=Path, metavar="FILE", help="write all followers in one table, as Markdown"
    )
    parser.add_argument("--jobs", type=at_least(1), default=1, metavar="N", help="processes (default: %(default)s)")
    parser.add_argument("--out", type=Path, default=Path("out/compare"), metavar="DIR", help="default: %(default)s")


def run(options: argparse.Namespace) -> int:
    """Drive what has not been driven, print and write the table."""
    followers = list(dict.fromkeys(options.followers))
    if len(followers) < 2:
        raise InputError(f"--followers must name two or more, got {shown(followers)}")
    require_workers(options.jobs, "--jobs")
    _check_followers(followers, options.suites[0], options.slam)
    if options.plot:
        require_matplotlib()
    episodes = QUICK if options.quick else options.episodes
    file = made_folder(options.out) / "episodes.jsonl"
    rows = _driven(file, followers, options.suites, episodes, options.slam, options.jobs)
    cells = compare_cells(rows, followers)
    write_json(
        options.out / "results.json",
        {
            "followers": followers,
            "slam": options.slam,
            "cells": [cell.to_dict() for cell in cells],
            "machine": describe_machine(),
        },
    )
    write_text(options.out / "report.md", report(cells, followers))
    if options.leaderboard is not None:
        tours = {name: episodes * len(suite(name)) for name in dict.fromkeys(options.suites)}
        today = datetime.datetime.now(tz=datetime.UTC).date().isoformat()
        counts = {"episodes": episodes, "first_seed": FIRST_SEED}
        page = leaderboard(cells[-1], followers, tours, describe_machine(), **counts, date=today, slam=options.slam)
        write_text(options.leaderboard, page)
    if options.plot:
        from ..figures.trade_off import draw_trade_off

        print(f"wrote {draw_trade_off(cells, options.out / 'trade_off.png')}")
    print(format_table(("cell", "n", *followers), [_line(cell, followers) for cell in cells]))
    print(f"wrote {options.out / 'report.md'}")
    return 0


def _check_followers(followers: Sequence[str], name: str, slam: str | None) -> None:
    """Refuse, before any drive, who is unknown or cannot drive in such an environment."""
    env = scenario_environment(name, 0, slam)
    for who in followers:
        make_follower(who, env.get_wrapper_attr("interface"))
    env.close()


def _driven(
    file: Path, followers: Sequence[str], suites: Sequence[str], episodes: int, slam: str | None, jobs: int
) -> list[dict[str, Any]]:
    """Return the rows of all episodes, driven now or before, episode by episode."""
    rows = {_key(row): row for row in finished_rows(file, slam)}
    asked = [
        (who, name, k)
        for name in dict.fromkeys(suites)
        for k in range(episodes * len(suite(name)))
        for who in followers
    ]
    missing = [(*key, slam) for key in asked if key not in rows]
    begun = len(asked) - len(missing)
    with runner("local", jobs) as run, tqdm(total=len(asked), initial=begun, unit="episode", leave=False) as progress:
        for row in run(episode_row, missing):
            rows[_key(row)] = row
            with file.open("a", encoding="utf-8") as lines:
                lines.write(json.dumps(row) + "\n")
            progress.update()
    write_text(file, "".join(sorted(file.read_text(encoding="utf-8").splitlines(keepends=True))))
    return [{**rows[key], "cell": suite(key[1])[key[2] % len(suite(key[1]))].name} for key in asked]


def _key(row: Mapping[str, Any]) -> tuple[str, str, int]:
    return row["follower"], row["suite"], row["episode"]


def _line(cell: ComparedCell, followers: Sequence[str]) -> tuple[str, ...]:
    return (cell.name, str(cell.episodes), *(f"{cell.done[who].mean:.2f}" for who in followers))
