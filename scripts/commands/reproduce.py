"""`tagalong reproduce EXPERIMENT`: repeats a published experiment and sets our figures beside the paper's."""

import argparse
import os
from pathlib import Path

from ...slam.errors import InputError
from ...slam.processes.crew import require_workers
from ..console.arguments import at_least
from ..console.subcommands import add_subcommands
from ..console.tables import format_table
from ..lab.backends import BACKENDS, MOST_CLUSTER_JOBS
from ..reproduce.experiment import EXPERIMENTS, load_experiment

EPILOG = """\
Writes results.json, timing.json, figures as PNG and one report.html. Everything is computed in cells that are stored
as they are done: interrupt or kill it at any time and run the same command again. Options of each experiment:
tagalong reproduce EXPERIMENT --help

example:
  tagalong reproduce {example} --quick --jobs 2 --out out/{example}
"""

_ALL, _ALL_SUMMARY = "all", "all of them, and a page for each: the evidence that is published"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the experiments, each with its own options."""
    parser.epilog = EPILOG.format(example=next(iter(EXPERIMENTS)))
    add_subcommands(parser, "experiment", {**EXPERIMENTS, _ALL: _ALL_SUMMARY}, _declare, required=True)


def _declare(name: str, parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="where everything is written")
    parser.add_argument("--quick", action="store_true", help="the same on fewer repeats")
    parser.add_argument("--jobs", type=at_least(1), default=1, metavar="N", help="processes (default: %(default)s)")
    parser.add_argument("--backend", choices=BACKENDS, default="local", help="who runs them (default: %(default)s)")
    parser.add_argument("--data", type=Path, metavar="DIR", help="recorded data (default: TAGALONG_DATA)")
    if name == _ALL:
        parser.add_argument("--pages", type=Path, metavar="DIR", help="where the pages go (default: OUT/pages)")
    else:
        load_experiment(name).add_arguments(parser)


def run(options: argparse.Namespace) -> int:
    """Run the experiment and say where its report is."""
    from ..reproduce.evidence import run_all
    from ..reproduce.run import run_experiment

    if options.backend == "local":
        require_workers(options.jobs, "--jobs")
    elif not 1 <= options.jobs <= MOST_CLUSTER_JOBS:
        raise InputError(f"--jobs must lie in [1, {MOST_CLUSTER_JOBS}] on a cluster, got {options.jobs}")
    variable = os.environ.get("TAGALONG_DATA")
    options.data = options.data or (Path(variable) if variable else None)
    if options.data is not None and not options.data.is_dir():
        raise InputError(f"--data: {options.data} is not a folder")
    if options.experiment == _ALL:
        run_all(options)
        return 0
    report = run_experiment(load_experiment(options.experiment), options)
    print(f"\n{report.title}\n\n{report.lead}\n")
    for section in report.sections:
        for table in section.tables:
            print(f"{table.title}\n{format_table(table.columns, table.rows)}\n")
    print(f"written to {options.out}: report.html, results.json, timing.json, figures/")
    return 0
