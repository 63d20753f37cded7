"""Options of the commands that look for people in a recording."""

import argparse

from ...perception.config import PRESETS
from ...perception.hindsight import LAG_S
from .arguments import within


def add_recorded_people(parser: argparse.ArgumentParser) -> None:
    """Declare `--preset`, `--forest` and `--lag`."""
    parser.add_argument(
        "--preset", default="recorded", help=f"numbers of the tracker: {', '.join(PRESETS)} (default: %(default)s)"
    )
    parser.add_argument("--forest", default="real", help='leg forest: "real", "simulation" or a file (default: real)')
    parser.add_argument(
        "--lag",
        type=within(0.0, 1e3),
        default=LAG_S,
        metavar="S",
        help="who is believed in so much later was there before [s]; 0: as a robot knows it (default: %(default)g)",
    )
