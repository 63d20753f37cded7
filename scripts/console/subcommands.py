"""Sub-commands whose code is imported only when they are the ones that are asked for, so that help comes at once."""

import argparse
from collections.abc import Callable, Mapping
from typing import Any, NoReturn

from ...slam.errors import InputError, one_line

_MOST_SAID = 400
"""Characters of a complaint about words, which argparse shows whole."""


class CommandParser(argparse.ArgumentParser):
    """An argument parser for which words that it does not understand are bad input like any other."""

    def error(self, message: str) -> NoReturn:
        """Refuse the words.

        Raises:
            InputError: With `message`, and where help is to be found.
        """
        raise InputError(f"{one_line(message, _MOST_SAID)} (see {self.prog} --help)")


class _LateSubcommands(argparse._SubParsersAction):
    """Lets the sub-command that was chosen declare its options just before they are read, and refuse what is none."""

    declare: Callable[[str, argparse.ArgumentParser], None]

    def __call__(self, parser: Any, namespace: Any, values: Any, option_string: Any = None) -> None:
        if values[0] in self.choices:
            self.declare(values[0], self.choices[values[0]])
        super().__call__(parser, namespace, values, option_string)
        unknown = getattr(namespace, argparse._UNRECOGNIZED_ARGS_ATTR, None)
        if unknown:  # else the parser at the top would say so, and point to its own help
            self.choices[values[0]].error(f"unrecognized arguments: {' '.join(unknown)}")


def add_subcommands(
    parser: argparse.ArgumentParser,
    kind: str,
    summaries: Mapping[str, str],
    declare: Callable[[str, argparse.ArgumentParser], None],
    *,
    required: bool = False,
) -> None:
    """Add sub-commands to a parser.

    Args:
        parser: Of the command above them.
        kind: What they are, such as "command": the name of the attribute that holds the one that was chosen, or None.
        summaries: Name -> what it does, in a line of the help.
        declare: Adds the options of the sub-command of a name to its parser; called for the chosen one alone.
        required: Whether one has to be chosen.
    """
    action = parser.add_subparsers(dest=kind, metavar=kind.upper(), required=required, action=_LateSubcommands)
    assert isinstance(action, _LateSubcommands)
    action.declare = declare
    for name, summary in summaries.items():
        action.add_parser(name, help=summary, description=summary, formatter_class=argparse.RawDescriptionHelpFormatter)


def add_described(
    group: "argparse._SubParsersAction[argparse.ArgumentParser]", name: str, summary: str, epilog: str
) -> argparse.ArgumentParser:
    """Return the parser of one more sub-command of `group`, with what it does in a line and an epilog as it stands."""
    return group.add_parser(
        name, help=summary, description=summary, epilog=epilog, formatter_class=argparse.RawDescriptionHelpFormatter
    )
