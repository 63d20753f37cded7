"""`tagalong perceive`: legs and people in recorded scans; planes and people in recorded RGB-D frames."""

import argparse
import sys
from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path
from zipfile import is_zipfile

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from ...perception.compiled_parts import track_people
from ...perception.config import perception_preset
from ...perception.hindsight import HindsightFilter
from ...perception.leader.selector import LeaderSelector, numbered_by_leader
from ...perception.people_filter import FilteredScan
from ...perception.tracking.people import People
from ...slam.drives.log import read_log
from ...slam.errors import InputError
from ...slam.files.output import write_json, write_text
from ...slam.first_use.compiling import compiled_together
from ...slam.first_use.parts import correct_drive
from ...slam.logs.scans_npz import read_scans_npz
from ...slam.scan import LaserScan
from ..console.arguments import within
from ..console.log_options import add_topics
from ..console.record_option import add_record, check_record
from ..console.recorded_people import add_recorded_people
from ..lab.people_recordings import recorded_people
from ..runs.perceive_frames import add_camera_options, holds_frames, perceive_frames

LEGS_HEADER, PEOPLE_HEADER = "scan,x,y,confidence", "scan,id,x,y,vx,vy,confidence"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.description = (
        "Finds legs and tracks people in recorded scans. SCANS is a CARMEN, BeeSoft, DP-SLAM or tinySLAM log\n"
        "(plain or .gz), a ROS bag (ROS 1: a file, ROS 2: a folder), or an .npz with ranges (scans, beams),\n"
        "angle_min, angle_increment, range_min, range_max and bag_time or stamp. Odometry that is not in it is made\n"
        "of the scans, by scan matching.\n"
        "Writes legs.csv (scan, x, y, confidence: clusters of at least --min-confidence; the tracker takes those of\n"
        "gamma = 0.3 and more), people.csv (scan, id, x, y, vx, vy, confidence) and config.json. Scans count from 0.\n"
        "Whoever is nearest at first is the leader: looked for when lost, and kept under one id.\n\n"
        "A folder of RGB-D frames (NAME_depth.png of 16 bit in millimetres, NAME.jpg or .png, and NAME.json or one\n"
        "camera.json with width, height, fx, fy, cx, cy) gives planes.csv, people.csv, mounts.csv, report.txt and\n"
        "overlays/NAME.png. So does a ROS 1, ROS 2 or MCAP bag with depth (raw or compressedDepth) and camera_info;\n"
        "colour (raw or compressed) may be missing. Height and tilt of the camera are told by the floor; where it is\n"
        "not in sight, by the options or, in a bag and with --sequence, by the frames before; else people are marked\n"
        "as guesses (floor_known 0)."
    )
    parser.epilog = (
        "examples:\n  tagalong perceive lobby.bag --out out/people\n"
        "  tagalong perceive frames/ --out out/frames --camera-height 1.3\n"
        "  tagalong perceive camera.bag --out out/frames --every 1"
    )
    parser.add_argument("scans", metavar="SCANS", type=Path, help="recorded scans: log, ROS bag or .npz; or frames")
    add_topics(parser)
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder for the results")
    add_recorded_people(parser)
    parser.add_argument(
        "--odometry",
        choices=("log", "scans", "none"),
        default="log",
        help="the log's own (where it has none, of its scans), of its scans, or none: the laser stands (default: log)",
    )
    parser.add_argument(
        "--frame",
        choices=("robot", "odometry"),
        default="robot",
        help="frame of people.csv: the robot's at each scan, or the odometry's (default: robot; legs: always robot)",
    )
    parser.add_argument(
        "--rate", type=within(0.01, 1e5), metavar="HZ", help="scans a second, for logs whose times are unusable"
    )
    add_record(parser)
    add_camera_options(parser)
    parser.add_argument(
        "--min-confidence", type=within(0.0, 1.0), default=0.1, help="of rows in legs.csv (default: 0.1)"
    )
    parser.add_argument("--quiet", action="store_true", help="no progress bar")


def run(options: argparse.Namespace) -> int:
    """Read the scans, track people through them, write the tables; or look at frames."""
    if holds_frames(options.scans, options.frames):
        return perceive_frames(options)
    with compiled_together(track_people, correct_drive):
        return _perceive_scans(options)


def _perceive_scans(options: argparse.Namespace) -> int:
    check_record(options.record)
    config = replace(perception_preset(options.preset), forest=options.forest)
    people_filter = HindsightFilter(config, lag_s=options.lag)
    selector = LeaderSelector(config.leader, config.tracker.motion)
    scans, odometry = _read(options)
    scans = _timed(scans, options.rate, options.scans)
    legs, people, ids = [LEGS_HEADER], [PEOPLE_HEADER], set[int]()
    hidden = options.quiet or not sys.stderr.isatty()
    told = people_filter.over(zip(scans, odometry, strict=True))
    progress = tqdm(told, total=len(scans), unit="scan", disable=hidden)
    with recorded_people(options.record, scans[0].time_s if scans else 0.0) as record:
        for number, update in enumerate(progress):
            pose = update.odometry
            legs += _leg_rows(number, update, options.min_confidence)
            found = numbered_by_leader(update.people, selector.update(update.people, pose))
            people += _people_rows(number, found.in_frame_of(pose) if options.frame == "robot" else found)
            ids |= {int(number) for number in found.ids}
            record(update, found)
    write_text(options.out / "legs.csv", "\n".join(legs) + "\n")
    write_text(options.out / "people.csv", "\n".join(people) + "\n")
    settings = {"preset": options.preset, "odometry": options.odometry}
    write_json(options.out / "config.json", {**settings, "frame": options.frame, "perception": asdict(config)})
    print(
        f"tracker: preset {options.preset}, leg forest {options.forest}; odometry {_source(options.odometry, odometry)}"
    )
    written = f"{options.out}/legs.csv, people.csv" + (f", {options.record}" if options.record else "")
    print(f"{len(scans)} scans, {len(legs) - 1} legs, {len(ids)} people; wrote {written}")
    return 0


def _read(options: argparse.Namespace) -> tuple[list[LaserScan], Sequence[NDArray[np.float64] | None]]:
    """Return the scans, and the odometry (3,) at each; None: it is made of the scans."""
    path, odometry = options.scans, None
    if not path.exists():
        raise InputError(f"no file {path}; give a CARMEN log, a ROS bag or an .npz of scans")
    if path.suffix == ".npz" or (path.is_file() and is_zipfile(path)):
        scans = read_scans_npz(path)
    else:
        drive = read_log(path, options.scan_topic, options.odometry_topic)
        for note in drive.notes:
            print(f"tagalong: {path}: {note}", file=sys.stderr)
        scans, odometry = drive.scans, drive.odometry if drive.has_odometry else None
    if options.odometry == "none":
        return scans, list(np.zeros((len(scans), 3)))
    if options.odometry == "log" and odometry is not None:
        return scans, list(odometry)
    return scans, [None] * len(scans)


def _source(asked: str, odometry: Sequence[NDArray[np.float64] | None]) -> str:
    """Return in words where the odometry comes from."""
    if asked == "none":
        return "none: the laser stands"
    if any(pose is None for pose in odometry):
        return "made of the scans" + (", for the log has none" if asked == "log" else "")
    return "of the log"


def _timed(scans: list[LaserScan], rate_hz: float | None, path: Path) -> list[LaserScan]:
    if rate_hz is not None:
        return [replace(scan, time_s=number / rate_hz) for number, scan in enumerate(scans)]
    times = np.array([scan.time_s for scan in scans])
    back = np.flatnonzero(~(np.diff(times) > 0.0))
    if len(back):
        raise InputError(
            f"{path}: times of scans must increase, scan {back[0] + 1} comes {times[back[0] + 1] - times[back[0]]} s "
            "after the one before it; give --rate HZ to count scans instead"
        )
    return scans


def _leg_rows(number: int, update: FilteredScan, least: float) -> list[str]:
    found = update.detections
    return [
        f"{number},{x:.4f},{y:.4f},{confidence:.4f}"
        for (x, y), confidence in zip(found.positions, found.confidence, strict=True)
        if confidence >= least
    ]


def _people_rows(number: int, people: People) -> list[str]:
    rows = zip(people.ids, people.positions, people.velocities, people.confidence, strict=True)
    return [f"{number},{i},{x:.4f},{y:.4f},{vx:.4f},{vy:.4f},{c:.4f}" for i, (x, y), (vx, vy), c in rows]
