"""`tagalong filter`: takes people out of a recorded drive."""

import argparse
import sys
from dataclasses import replace
from pathlib import Path

from tqdm import tqdm

from ...perception.compiled_parts import track_people
from ...perception.config import perception_preset
from ...perception.filtered_logs.log import Topics, filter_log
from ...slam.files.output import require_writable
from ...slam.first_use.compiling import compiled_together
from ...slam.first_use.parts import correct_drive
from ..console.log_options import add_topics
from ..console.recorded_people import add_recorded_people

EPILOG = """\
A CARMEN log has 0.0 (no measurement) for the returns of people. A ROS bag has four topics more, with the headers of the
scans:
  SCAN_filtered          sensor_msgs/LaserScan: NaN (no measurement) for the returns of people
  SCAN_filtered/people   geometry_msgs/PoseArray: people, x along the way that they walk
  SCAN_filtered/tracks   sensor_msgs/PointCloud2: the same people: x y z id vx vy confidence
  SCAN_filtered/legs     geometry_msgs/PoseArray: the legs of people seen in this scan
Nothing else changes, byte for byte. OUT appears when it is complete. Memory does not grow with the length of the drive
(but for the index of a ROS 1 bag). A bag without odometry gets it from its scans, by scan matching; one that is grossly
wrong about its odometry or its laser, or whose laser spins slowly, is found out by its first scans.

Nobody is a person at first sight. A recording can wait: whoever is known to be one a second later is taken out of the
scans before, too.

example:
  tagalong filter lobby.bag lobby_filtered.bag
  tagalong filter drive.mcap drive_filtered.mcap --scan-topic /front/scan
  tagalong filter drive.log.gz drive_filtered.log.gz --forest simulation
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.description = "Takes people out of the scans of a recorded drive, so that any SLAM maps the building alone."
    parser.epilog = EPILOG
    parser.add_argument(
        "log", metavar="IN", type=Path, help="CARMEN log (plain or .gz), ROS 1 bag, MCAP file or ROS 2 bag folder"
    )
    parser.add_argument("target", metavar="OUT", type=Path, help="the same, without people; a folder must be new")
    add_topics(parser)
    parser.add_argument("--topic", metavar="NAME", help="of the filtered scans (default: the scans', and _filtered)")
    add_recorded_people(parser)
    parser.add_argument("--quiet", action="store_true", help="no progress bar")


def run(options: argparse.Namespace) -> int:
    """Filter the log, say what was found."""
    config = replace(perception_preset(options.preset), forest=options.forest)
    require_writable(options.target, folder=options.log.is_dir())
    topics = Topics(scans=options.scan_topic, odometry=options.odometry_topic, filtered=options.topic)
    together = compiled_together(track_people, correct_drive)
    with together, tqdm(unit="scan", disable=options.quiet or not sys.stderr.isatty()) as bar:
        result = filter_log(options.log, options.target, config, topics, bar.update, options.lag)
    for note in result.notes:
        print(f"tagalong: {options.log}: {note}", file=sys.stderr)
    print(f"tracker: preset {options.preset}, leg forest {options.forest}")
    counts = result.counts
    share = 100.0 * counts.removed / max(counts.returns, 1)
    print(
        f"{counts.scans} scans, {len(counts.people)} people, {share:.2f} % of returns removed; wrote {options.target}"
    )
    if result.topic:
        print(f"added: {result.topic}, and its people, tracks and legs ({result.topic}/people, ...)")
    return 0
