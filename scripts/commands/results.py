"""`tagalong results`: measures what the README states."""

import argparse
import os
from dataclasses import asdict
from datetime import date
from pathlib import Path

from ...slam.errors import InputError
from ...slam.files.output import write_json
from ...slam.processes.crew import require_workers
from ..console.arguments import at_least
from ..console.tables import format_table
from ..lab.cells import run_cells
from ..lab.hardware import describe_machine

EPILOG = """\
Following (30 seeds a scene), maps (5), tracking (10), recorded logs (5 each; where --data or the variable TAGALONG_DATA
names a folder that holds slam_logs). Every cell is stored as it is done: interrupt it at any time and run the same
command again. Writes results.json and the cells into DIR; --readme replaces the table between the README's marks.

example:
  tagalong results --out out/results --jobs 2 --readme README.md
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.epilog = EPILOG
    parser.add_argument("--out", type=Path, default=Path("out/results"), metavar="DIR", help="(default: %(default)s)")
    parser.add_argument("--jobs", type=at_least(1), default=1, help="processes (default: %(default)s)")
    parser.add_argument("--quick", action="store_true", help="the same on few seeds")
    parser.add_argument("--data", type=Path, metavar="DIR", help="recorded data (default: TAGALONG_DATA)")
    parser.add_argument("--readme", type=Path, metavar="FILE", help="write the table into this file")


def run(options: argparse.Namespace) -> int:
    """Run the missing cells, print the table, write it."""
    from ..benchmarks.acceptance import FULL, QUICK, acceptance_cells
    from ..benchmarks.acceptance_table import require_readme, result_rows, write_readme_table

    require_workers(options.jobs, "--jobs")
    variable = os.environ.get("TAGALONG_DATA")
    data = options.data or (Path(variable) if variable else None)
    if data is not None and not (data / "slam_logs").is_dir():
        raise InputError(f"{data}: needs a folder slam_logs, found none")
    if options.readme is not None:
        require_readme(options.readme)
    extent = QUICK if options.quick else FULL
    results = run_cells(acceptance_cells(extent, data), options.out / "cells", jobs=options.jobs, label="results")
    rows, machine = result_rows(results), describe_machine()
    print(format_table(("measured", "mean [95 % interval]", "others", "n"), rows))
    table = [dict(zip(("measured", "value", "others", "n"), row, strict=True)) for row in rows]
    write_json(
        options.out / "results.json",
        {"version": 1, "extent": asdict(extent), "machine": machine, "table": table, "cells": results},
    )
    if options.readme is not None:
        write_readme_table(options.readme, rows, machine, date.today())
    return 0
