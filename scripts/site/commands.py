"""A page of every command's help, as the command itself prints it."""

import argparse

from ..cli import COMMANDS
from .named import module_named

_WIDTH = 92


def commands_page() -> tuple[str, str]:
    """Return (path, Markdown) of the page of all commands."""
    rows = ["| command | what it does |", "|---|---|"]
    rows += [f"| [`tagalong {name}`](#{name}) | {summary} |" for name, summary in COMMANDS.items()]
    parts = ["# Commands", "\n".join(rows)]
    for name, summary in COMMANDS.items():
        parts.append(f"## {name}\n\n```text\n{help_of(name, summary)}\n```")
    return "reference/commands.md", "\n\n".join(parts) + "\n"


def help_of(name: str, summary: str) -> str:
    """Return the help of a command, of the same width on every terminal."""
    parser = argparse.ArgumentParser(
        prog=f"tagalong {name}",
        description=summary,
        formatter_class=lambda prog: argparse.RawDescriptionHelpFormatter(prog, width=_WIDTH),
    )
    module_named(f"scripts.commands.{name}").add_arguments(parser)
    return parser.format_help().strip()
