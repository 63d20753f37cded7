"""Where a benchmark's figures go."""

import argparse
from collections.abc import Mapping
from typing import Any

from ...slam.files.output import write_json
from ..lab.hardware import describe_machine

_NOT_SETTINGS = ("command", "name", "run", "out")


def write_results(options: argparse.Namespace, content: Mapping[str, Any]) -> None:
    """Write results.json into `options.out`: what was asked for, the machine, and `content`."""
    settings = {name: value for name, value in vars(options).items() if name not in _NOT_SETTINGS}
    write_json(options.out / "results.json", {"options": settings, "machine": describe_machine(), **content})
