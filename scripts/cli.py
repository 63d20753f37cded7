"""The command `tagalong`: finds the sub-command, prints user errors in one line."""

import argparse
import sys
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from importlib import import_module
from typing import NoReturn

from .. import __version__
from ..slam.errors import InputError, WorkerError, one_line, shown
from ..slam.files.output import require_writable
from .interruption import interruptible
from .last_words import MOST_SAID, exit_status
from .only_writer import only_writer

# name -> what it does; the code is in commands/NAME.py, imported only when it is used
COMMANDS: dict[str, str] = {
    "demo": "follow a person, map raw and filtered, compare: the main job",
    "slam": "map a recorded drive (log or ROS bag)",
    "localize": "find a recorded drive on a finished map",
    "score": "judge a trajectory or a map by a reference",
    "train": "train the leg forests, the classifier of people, or a follower",
    "doctor": "say what is installed and what works here",
    "teleop": "drive by stick, record it, replay it",
    "evaluate": "drive a follower through many episodes",
    "results": "measure what the README states",
    "reproduce": "repeat a published experiment",
    "bench": "measure speed",
    "perceive": "find legs and track people in recorded scans (log, ROS bag or .npz)",
}

_LARGEST_SEED = 2**32 - 1  # what every generator takes


def main(arguments: Sequence[str] | None = None) -> int:
    """Run `tagalong ARGUMENTS` and return the exit status.

    0 fine, 1 a stated bound was missed, 2 bad input, 3 a worker process was lost, 128 + n ended by signal n (130 by
    Ctrl-C, 143 by SIGTERM).
    """
    words = list(sys.argv[1:] if arguments is None else arguments)
    return told(lambda: _run(words), is_program=arguments is None)


def told(run: Callable[[], int], *, is_program: bool = True) -> int:
    """Return the exit status of `run`, as of `main`; what went wrong is told in one line.

    Args:
        run: What to do.
        is_program: The process has nothing else to do.
    """
    return interruptible(lambda: _told(run), is_program=is_program)


def _told(run: Callable[[], int]) -> int:
    try:
        return exit_status(run)
    except WorkerError as error:
        print(f"tagalong: {one_line(str(error), MOST_SAID)}", file=sys.stderr)
        return 3


class _Parser(argparse.ArgumentParser):
    """Shows words of thousands of characters in a few."""

    def error(self, message: str) -> NoReturn:
        """Print the usage and `message`, and exit with status 2."""
        super().error(one_line(message, MOST_SAID))


def _run(words: list[str]) -> int:
    parser = _Parser(
        prog="tagalong",
        description="Follow a person through a building, map it on the way, keep the people out of the map.",
        epilog="Each command has its own --help with an example.",
    )
    parser.add_argument("--version", action="version", version=f"tagalong {__version__}")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND")
    for name, summary in COMMANDS.items():
        sub = commands.add_parser(
            name, help=summary, description=summary, formatter_class=argparse.RawDescriptionHelpFormatter
        )
        if words and words[0] == name:
            command = import_module(f".commands.{name.replace('-', '_')}", __package__)
            command.add_arguments(sub)
            sub.set_defaults(run=command.run)
    options = parser.parse_args(words)
    if options.command is None:
        parser.print_help()
        return 0
    out_is_folder = getattr(options, "out_is_folder", True)
    if getattr(options, "out", None) is not None:
        require_writable(options.out, folder=out_is_folder)
    if not 0 <= (getattr(options, "seed", None) or 0) <= _LARGEST_SEED:
        raise InputError(f"--seed must not be negative, nor above {_LARGEST_SEED}, got {shown(options.seed)}")
    with only_writer(options.out) if getattr(options, "out", None) and out_is_folder else nullcontext():
        return int(options.run(options))
