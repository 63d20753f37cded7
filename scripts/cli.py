"""The command `tagalong`: finds the sub-command, prints user errors in one line."""

import argparse
import sys
from collections.abc import Sequence
from contextlib import nullcontext
from importlib import import_module

from .. import __version__
from ..slam.files.output import require_writable
from .console.first_call import tell_first_call
from .console.last_words import told
from .console.only_writer import only_writer
from .console.subcommands import CommandParser, add_subcommands

# name -> what it does; the code is in commands/NAME.py, imported only when it is used
COMMANDS: dict[str, str] = {
    "demo": "follow a person, map raw and filtered, compare: the main job",
    "slam": "map a recorded drive (log or ROS bag)",
    "filter": "take people out of a recorded drive (log, ROS bag, MCAP): the same out, for any SLAM",
    "localize": "find a recorded drive on a finished map",
    "score": "judge a trajectory or a map by a reference",
    "train": "train the leg forests, the classifier of people, or a follower",
    "data": "say which public recordings the figures rest on, and check a folder of them",
    "doctor": "say what is installed and what works here",
    "teleop": "drive by stick, record it, replay it",
    "evaluate": "drive a follower through many episodes",
    "record": "drive followers and write what they did as datasets to learn from (Minari, LeRobot)",
    "compare": "followers on suites, cell by cell, in one table",
    "results": "measure what the README states",
    "reproduce": "repeat a published experiment",
    "bench": "run a benchmark: speed, SLAM, people, followers, long runs",
    "ros": "run a node of ROS 2 on a robot: filter, people, follower, slam",
    "perceive": "find legs and track people in recorded scans (log, ROS bag or .npz)",
}

_TARGETS = {"json": False, "overlay": False, "leaderboard": False, "readme": False, "pages": True}
"""Options beside --out that name what is written in the end, and whether that is a folder."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run `tagalong ARGUMENTS` and return the exit status, as of `told`."""
    words = list(sys.argv[1:] if arguments is None else arguments)
    return told(lambda: _run(words), is_program=arguments is None)


def make_parser() -> CommandParser:
    """Return what understands the words of every command."""
    parser = CommandParser(
        prog="tagalong",
        description="Follow a person through a building, map it on the way, keep the people out of the map.",
        epilog="Each command has its own --help with an example.",
    )
    parser.add_argument("--version", action="version", version=f"tagalong {__version__}")
    add_subcommands(parser, "command", COMMANDS, _declare)
    return parser


def _run(words: list[str]) -> int:
    parser = make_parser()
    options = parser.parse_args(words)
    if options.command is None:
        parser.print_help()
        return 0
    out_is_folder = getattr(options, "out_is_folder", True)
    if options.command != "data":
        tell_first_call()
    for name, is_folder in {"out": out_is_folder, **_TARGETS}.items():
        if getattr(options, name, None) is not None:
            require_writable(getattr(options, name), folder=is_folder)
    with only_writer(options.out) if getattr(options, "out", None) and out_is_folder else nullcontext():
        return int(options.run(options))


def _declare(name: str, parser: argparse.ArgumentParser) -> None:
    command = import_module(f".commands.{name}", __package__)
    parser.set_defaults(run=command.run)
    command.add_arguments(parser)
