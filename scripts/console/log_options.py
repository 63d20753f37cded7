"""Options of commands that read recorded drives, and the reading itself."""

import argparse
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

from ...slam.drives.log import read_log
from ...slam.drives.made_odometry import with_made_odometry
from ...slam.errors import InputError, unknown_name
from ...slam.logs.drive import RecordedDrive
from ...slam.scan_to_scan import MATCHERS
from ...slam.scan_to_scan.laser_odometry import LaserOdometryConfig
from .setting_words import read_settings

SOURCES = ("log", "laser", "refined")
"""Where the odometry comes from: the log (from its scans, if it has none), its scans alone, or both."""


@dataclass(frozen=True, eq=False)
class ReadDrive:
    """A drive as a command uses it.

    Attributes:
        drive: The drive.
        settings: How its odometry was made from its scans, for the results; empty where it is the log's own.
    """

    drive: RecordedDrive
    settings: dict[str, Any] = field(default_factory=dict)


def add_topics(parser: argparse.ArgumentParser) -> None:
    """Declare the options that choose the topics of a ROS bag."""
    parser.add_argument("--scan-topic", metavar="NAME", help="of a ROS bag with several topics of laser scans")
    parser.add_argument("--odometry-topic", metavar="NAME", help="of a ROS bag with several topics of odometry")


def add_odometry(parser: argparse.ArgumentParser) -> None:
    """Declare the options that say where the odometry comes from."""
    parser.add_argument(
        "--odometry",
        default="log",
        metavar="SOURCE",
        help="log: the log's own, made from its scans where it has none; laser: from its scans alone, by scan "
        "matching; refined: the log's own, refined by matching each scan with one before (default: %(default)s)",
    )
    parser.add_argument("--matcher", metavar="NAME", help=f"what matches them: {', '.join(MATCHERS)} (default: plicp)")
    parser.add_argument(
        "--matcher-set",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help="a field of the matcher's configuration, e.g. last_reach=0.2; may be repeated",
    )


def read_with_odometry(options: argparse.Namespace) -> ReadDrive:
    """Return the drive in `options.log`, with odometry from where `options` say.

    What was assumed, and what was found wrong with its odometry and put right, is said on stderr.

    Raises:
        InputError: If the log cannot be read, an option is wrong, or the log has no odometry that could be refined.
    """
    if options.odometry not in SOURCES:
        raise unknown_name("source of odometry", options.odometry, SOURCES)
    settings = read_settings(options.matcher_set, "--matcher-set")
    config = LaserOdometryConfig(matcher=options.matcher or "plicp", settings=settings)
    drive = _read_and_tell(options)
    if drive.has_odometry and options.odometry == "log":
        if options.matcher or settings:
            raise InputError("--matcher matches nothing where the log has odometry; add --odometry refined or laser")
        return ReadDrive(drive)
    refined = options.odometry == "refined"
    moved, made = with_made_odometry(drive, config, refined=refined)
    _tell(options, moved.notes[len(drive.notes) :])
    lost, what = int((~made.matched).sum()), "refined by" if refined else "made from"
    said = f"odometry is {what} the scans; {lost} of {len(drive)} could not be matched with one before"
    print(f"tagalong: {said}", file=sys.stderr)
    source = "refined" if refined else "laser"
    return ReadDrive(moved, {"odometry": {"source": source, **asdict(config)}})


def _read_and_tell(options: argparse.Namespace) -> RecordedDrive:
    """Return the drive in `options.log`; say what was assumed."""
    drive = read_log(options.log, options.scan_topic, options.odometry_topic)
    _tell(options, drive.notes)
    if options.odometry == "refined" and not drive.has_odometry:
        raise InputError(f"{options.log}: has no odometry to refine; `--odometry laser` makes it from the scans")
    return drive


def _tell(options: argparse.Namespace, notes: Sequence[str]) -> None:
    for note in notes:
        print(f"tagalong: {options.log}: {note}", file=sys.stderr)
