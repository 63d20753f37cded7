"""Planes and people in recorded RGB-D frames, of a folder or a bag: tables, overlays and a report."""

import argparse
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np

from ...perception.rgbd.bag_frames import holds_frames_only, read_bag_frames
from ...perception.rgbd.bag_topics import CameraTopics
from ...perception.rgbd.frame import RgbdFrame
from ...perception.rgbd.mount import Mount
from ...perception.rgbd.noise import NOISE, depth_noise
from ...perception.rgbd.people import RgbdPeople
from ...perception.rgbd.people_finder import PeopleFinder
from ...perception.rgbd.pictures import RecordedFrame, read_frames
from ...perception.rgbd.planes import PlaneConfig, PlaneFinder, Planes, Surface
from ...slam.errors import InputError
from ...slam.files.output import write_json, write_text
from ...slam.logs.bag_messages import is_bag
from ..console.arguments import HIGHEST_M, within
from ..console.tables import format_table
from ..figures.planes import save_planes

PLANES_HEADER = "frame,kind,nx,ny,nz,offset_m,height_m,pixels,likelihood"
PEOPLE_HEADER = "frame,x,y,distance_m,likelihood,floor_known"
MOUNTS_HEADER = "frame,floor,height_m,pitch_deg,roll_deg,sd_height_m,sd_pitch_deg,sd_roll_deg"
WORDS = {"depth": "depth pictures", "colour": "colour pictures", "camera-info": "intrinsics (of the depth)"}
_HIGHEST_M = 100.0
_EVERY_S = 0.5
_LONGEST_S = 3600.0


@dataclass(frozen=True, eq=False)
class SeenFrame:
    """What was found in one frame.

    Attributes:
        name: Its name in the folder.
        planes: Its planes.
        people: Who is in it.
    """

    name: str
    planes: Planes
    people: RgbdPeople

    @property
    def floor(self) -> str:
        """How the floor is known: seen, held (from a frame before, or as told) or unknown."""
        mount = self.planes.mount
        return "seen" if mount.floor_seen else "held" if mount.known else "unknown"


def add_camera_options(parser: argparse.ArgumentParser) -> None:
    """Declare what can be told of a camera whose frames are looked at."""
    group = parser.add_argument_group("of RGB-D frames, in a folder or a bag")
    group.add_argument(
        "--camera-height", type=within(0.01, HIGHEST_M), metavar="M", help="above the floor, within 0.15 m or so"
    )
    group.add_argument(
        "--camera-tilt",
        type=within(-90.0, 90.0),
        nargs=2,
        metavar=("PITCH", "ROLL"),
        help="nose down, left side up [deg]",
    )
    group.add_argument(
        "--sensor",
        choices=tuple(NOISE),
        default="structured-light",
        help="whose noise the depths have (default: %(default)s)",
    )
    group.add_argument(
        "--sequence", action="store_true", help="the frames are one drive's, in the order of their names"
    )
    group.add_argument("--frames", action="store_true", help="of a bag with scans, too: look at its frames instead")
    group.add_argument(
        "--every",
        type=within(0.0, 3600.0),
        metavar="S",
        help="of a bag: leave out frames that follow sooner [s] (default: 0.5)",
    )
    for what in ("depth", "colour", "camera-info"):
        group.add_argument(f"--{what}-topic", metavar="NAME", help=f"of a bag with several topics of {WORDS[what]}")
    group.add_argument("--no-overlays", action="store_true", help="draw nothing")


def holds_frames(path: Path, wanted: bool) -> bool:
    """Return whether `path` is a folder of RGB-D frames, or a bag whose frames are `wanted` or that has no scans.

    The folder of a ROS 2 bag is a bag.
    """
    if is_bag(path):
        return wanted or holds_frames_only(path)
    return path.is_dir() or wanted


def perceive_frames(options: argparse.Namespace) -> int:
    """Find planes and people in each frame of the folder, write the tables, the overlays and the report."""
    _check(options)
    config = PlaneConfig(noise=depth_noise(options.sensor))
    planes, people, mounts, seen = [PLANES_HEADER], [PEOPLE_HEADER], [MOUNTS_HEADER], []
    for each in _look(options, config):
        planes += _plane_rows(each)
        people += _people_rows(each)
        mounts.append(_mount_row(each))
        seen.append(_report_row(each))
        if not options.no_overlays:
            save_planes(options.out / "overlays" / f"{each.name}.png", each.planes, each.people)
    for name, rows in (("planes", planes), ("people", people), ("mounts", mounts)):
        write_text(options.out / f"{name}.csv", "\n".join(rows) + "\n")
    report = format_table(("frame", "floor", "height m", "pitch deg", "roll deg", "tops", "people", "at m"), seen)
    write_text(options.out / "report.txt", report + "\n")
    told = {"height_m": options.camera_height, "tilt_deg": options.camera_tilt}
    how = {"told": told, "sequence": options.sequence or is_bag(options.scans), "planes": asdict(config)}
    write_json(options.out / "config.json", how)
    print(report)
    print(f"{len(seen)} frames, {len(people) - 1} people; wrote {options.out}/report.txt, planes, people, mounts .csv")
    return 0


def _check(options: argparse.Namespace) -> None:
    if options.record is not None:
        raise InputError("--record is for scans: what is found in frames is drawn into overlays/")


def _look(options: argparse.Namespace, config: PlaneConfig) -> Iterator[SeenFrame]:
    planes_finder, people_finder = PlaneFinder(config), PeopleFinder.load()
    before: Mount | None = None
    sequence = options.sequence or is_bag(options.scans)
    for recorded in _frames(options):
        planes = planes_finder.find(_told(recorded.frame, options), before)
        before = planes.mount if sequence else None
        yield SeenFrame(recorded.name, planes, people_finder.find(planes.frame, planes))


def _frames(options: argparse.Namespace) -> Iterator[RecordedFrame]:
    """Yield the frames of the folder, or of the bag."""
    if not is_bag(options.scans):
        return read_frames(options.scans)
    topics = CameraTopics(depth=options.depth_topic, colour=options.colour_topic, depth_info=options.camera_info_topic)
    return read_bag_frames(options.scans, topics, _EVERY_S if options.every is None else options.every)


def _told(frame: RgbdFrame, options: argparse.Namespace) -> RgbdFrame:
    tilt = None if options.camera_tilt is None else tuple(np.radians(options.camera_tilt).tolist())
    return replace(frame, camera_height=options.camera_height, tilt=tilt)


def _plane_rows(each: SeenFrame) -> list[str]:
    planes, rows = each.planes, []
    for k, kind in enumerate(planes.kinds):
        mine = planes.region == k
        if not mine.any():
            continue
        (nx, ny, nz), height = planes.normals[k], planes.points[mine, 2].mean()
        row = f"{each.name},{Surface(kind).name.lower()},{nx:.4f},{ny:.4f},{nz:.4f},{planes.offsets[k]:.4f}"
        rows.append(f"{row},{height:.3f},{mine.sum() * planes.step**2},{planes.likelihood[k]:.2f}")
    return rows


def _people_rows(each: SeenFrame) -> list[str]:
    found, known = each.people, int(each.people.floor_known)
    rows = zip(found.positions, found.likelihood, strict=True)
    return [f"{each.name},{x:.3f},{y:.3f},{np.hypot(x, y):.3f},{sure:.3f},{known}" for (x, y), sure in rows]


def _mount_row(each: SeenFrame) -> str:
    mount = each.planes.mount
    pitch, roll = np.degrees((mount.pitch, mount.roll))
    sd_pitch, sd_roll, sd_height = np.sqrt(np.diag(mount.covariance))
    spread = f"{sd_height:.3f},{np.degrees(sd_pitch):.2f},{np.degrees(sd_roll):.2f}"
    return f"{each.name},{each.floor},{mount.height:.3f},{pitch:.2f},{roll:.2f},{spread}"


def _report_row(each: SeenFrame) -> list[str]:
    mount, tops = each.planes.mount, int((each.planes.kinds == Surface.TOP).sum())
    pitch, roll = np.degrees((mount.pitch, mount.roll))
    places = " ".join(f"{np.hypot(*place):.1f}" for place in each.people.positions) or "-"
    shown = [f"{mount.height:.2f}", f"{pitch:.1f}", f"{roll:.1f}"] if mount.known else ["-", "-", "-"]
    doubtful = "" if each.people.floor_known else "?"
    return [each.name, each.floor, *shown, str(tops), f"{len(each.people)}{doubtful}", places]
