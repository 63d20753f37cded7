"""The option `--record` of commands that drive or map."""

import argparse
from pathlib import Path

from ...slam.logs.recording import check_recording


def add_record(parser: argparse.ArgumentParser) -> None:
    """Declare the option."""
    parser.add_argument(
        "--record",
        type=Path,
        metavar="FILE",
        help="record it, too: FILE.mcap as ROS 2 messages (extra `ros`), FILE.rrd for rerun (extra `rerun`)",
    )


def check_record(path: Path | None) -> None:
    """Complain, before the work, of a recording that could not be written after it.

    Raises:
        InputError: If the file has another ending, or nothing can be written there.
        MissingExtraError: If its extra is not installed.
    """
    if path is not None:
        check_recording(path)
