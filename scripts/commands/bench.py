"""`tagalong bench NAME`: the committed benchmarks."""

import argparse
from pathlib import Path

from ..benchmarks.benchmark import BENCHMARKS, load_benchmark
from ..console.subcommands import add_subcommands
from ..console.tables import format_table

EPILOG = """\
Each prints a table and writes it as JSON, with the hardware noted, into a folder (--out; out/bench/NAME by default).
Options of each: tagalong bench NAME --help. Without a name they are listed.

example:
  tagalong bench speed --steps 300
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the benchmarks, each with its own options."""
    parser.epilog = EPILOG
    add_subcommands(parser, "name", BENCHMARKS, _declare)


def run(options: argparse.Namespace) -> int:
    """Run the benchmark of a name; list them all without one."""
    if options.name is None:
        print(format_table(("tagalong bench NAME", "what it measures"), BENCHMARKS.items()))
        return 0
    return load_benchmark(options.name).run(options)


def _declare(name: str, parser: argparse.ArgumentParser) -> None:
    benchmark = load_benchmark(name)
    parser.description = benchmark.__doc__
    parser.add_argument(
        "--out", type=Path, default=Path("out/bench") / name, metavar="DIR", help="(default: %(default)s)"
    )
    benchmark.add_arguments(parser)
