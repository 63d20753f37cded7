"""Long runs: whether memory and time stay flat, over episodes in all scenes and over laps of a log through each engine.

After the first tenth neither may grow by more than 5 %; the exit status is 1 where one does. Each part runs in a
process of its own, so that none sees the memory of another; what this code has finished is not run again.

The steps are shared by rounds through all registered environments with and without SLAM, and one endless episode.

example:
  tagalong bench soak --steps 1000000 --laps 50 --log intel.log.gz
"""

import argparse
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ...slam.engine import ENGINES
from ...slam.errors import InputError, unknown_name
from ..console.arguments import at_least
from ..console.tables import format_table
from ..lab.cells import TIMING, Cell
from ..lab.own_process import run_alone
from ..lab.trend import MOST_GROWTH, trend
from .results import write_results
from .soak_episodes import endless_episode, episodes
from .soak_laps import engine_laps

DRIVES = {"gmapping": "office", "cartographer": "office", "ekf": "landmarks"}
"""Engine -> the scene that is driven through where no log is given: the EKF needs its posts."""


SHARES = (
    ("episodes/none", episodes, None, 0.4),
    ("episodes/truth", episodes, "truth", 0.2),
    ("episodes/default", episodes, "default", 0.3),
    ("endless/none", endless_episode, None, 0.1),
)
"""Name, function, SLAM and share of the steps of each part; "default" is each environment's own engine."""


MOST_STEPS = 10**10
"""A year."""
FEWEST_STEPS = 20_000
"""With fewer, a part has a row or none."""


def cells(options: argparse.Namespace) -> list[Cell]:
    """Return the parts that are asked for."""
    made = []
    for name, function, slam, share in SHARES if options.steps else ():
        arguments: dict[str, Any] = {"slam": slam, "steps": round(share * options.steps)}
        made.append(Cell(name=name, function=function, arguments=arguments))
    for engine in options.engines if options.laps else ():
        log = DRIVES[engine] if options.log is None else str(options.log.absolute())
        arguments = {"method": engine, "log": log, "scans": options.scans, "laps": options.laps}
        made.append(Cell(name=f"laps/{engine}", function=engine_laps, arguments=arguments))
    return made


def table(results: Mapping[str, Any]) -> str:
    """Return what came out, as text."""
    rows = []
    for name, result in results.items():
        went = trend(result[TIMING])
        memory, times = f"{100.0 * went.memory_growth:+.1f} %", f"{100.0 * went.time_growth:+.1f} %"
        figures = f"{went.settled_mb:.0f}", f"{went.largest_mb:.0f}", memory, f"{went.bytes_a_step:.0f}"
        clock = f"{went.settled_ms:.2f}", f"{went.last_ms:.2f}", times
        rows.append((name, str(result[TIMING][-1]["done"]), *figures, *clock, "flat" if went.flat else "GROWS"))
    titles = ("MB settled", "most", "growth", "bytes a step", "ms settled", "last", "growth", f"<= {MOST_GROWTH:.0%}")
    return format_table(("part", "steps", *titles), rows)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument(
        "--steps", type=at_least(0, MOST_STEPS), default=1_000_000, help="environment steps (default: %(default)s)"
    )
    parser.add_argument("--laps", type=at_least(0), default=50, help="laps through each engine (default: %(default)s)")
    parser.add_argument("--log", type=Path, help="a log to drive to and fro (default: a simulated drive)")
    parser.add_argument("--scans", type=at_least(2), help="how many of its scans, from the first on (default: all)")
    parser.add_argument("--engines", nargs="+", default=list(ENGINES), metavar="ENGINE", help="(default: all)")


def run(options: argparse.Namespace) -> int:
    """Measure, print, write results.json."""
    for name in options.engines:
        if name not in ENGINES:
            raise unknown_name("SLAM engine", name, ENGINES)
    if options.laps == 1 or 0 < options.steps < FEWEST_STEPS:
        least = f"at least 2 laps and {FEWEST_STEPS} steps, or 0 for none"
        raise InputError(f"a trend needs {least}, got {options.laps} and {options.steps}")
    results = {cell.name: run_alone(cell, options.out) for cell in cells(options)}
    trends = {name: trend(result[TIMING]) for name, result in results.items()}
    write_results(options, {"results": results})
    print(table(results))
    return int(not all(went.flat for went in trends.values()))
