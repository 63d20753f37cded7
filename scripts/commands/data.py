"""`tagalong data`: which public recordings the figures rest on, and whether a folder holds them."""

import argparse
import math
import os
from collections import Counter
from pathlib import Path

from ...slam.errors import InputError
from ...slam.logs.recording import check_recording
from ..console.arguments import HIGHEST_M, random_seed, within
from ..console.subcommands import add_subcommands
from ..console.tables import format_table
from ..public_data.catalogue import DAMAGED, MISSING, OK, Collection, catalogue
from ..public_data.derive import RECIPES, derive

EPILOG = """\
None of these recordings is part of the package: most are free for research with credit to who made them, and no more.
Get them from where they come from, lay them as the paths say, and name the folder in the variable TAGALONG_DATA.
docs/data.md says how each file that is not an original derives from one.

record writes a drive through the simulated lab, by laser, wheels and RGB-D camera, as a ROS 2 bag, and its true poses
beside it (FILE.gt.tum); tagalong slam --mapping immobile and tagalong perceive --frames take it.

derive makes those of them that a program here makes, and says whether they are equal to ours.

check exits with 0 if every file is there and holds what it should, with 1 if not. A checksum is that of what a file
unpacks to, so it may be packed anew; that of an .npz is of its arrays.

examples:
  tagalong data
  tagalong data check DIR
  tagalong data check DIR --only slam_logs
  tagalong data derive DIR
  tagalong data record lab.mcap --seed 111 --pitch 20
"""
_MOST_MINUTES = 60.0
_ACTIONS = {
    "check": "say what is there, damaged, missing",
    "derive": "make files that derive from originals, where a program here does so",
    "record": "record a drive through the simulated lab, by laser and RGB-D camera",
}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.epilog = EPILOG
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    add_subcommands(parser, "action", _ACTIONS, _declare)


def _declare(name: str, parser: argparse.ArgumentParser) -> None:
    if name == "record":
        return _declare_record(parser)
    parser.add_argument("folder", type=Path, nargs="?", metavar="DIR", help="(default: TAGALONG_DATA)")
    if name == "derive":
        parser.add_argument("--into", type=Path, metavar="DIR", help="(default: the same folder); overwrites nothing")
        return None
    parser.add_argument("--only", metavar="PATH", default="", help="only files whose path begins so, e.g. slam_logs")


def _declare_record(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("file", type=Path, metavar="FILE", help="FILE.mcap")
    parser.add_argument("--seed", type=random_seed, default=0, help="of building, people and noise (0)")
    parser.add_argument(
        "--camera-hz", type=within(0.1, 1000.0), default=5.0, metavar="F", help="frames a second (default: 5)"
    )
    parser.add_argument(
        "--camera-height", type=within(0.01, HIGHEST_M), default=1.0, metavar="M", help="above the floor (default: 1.0)"
    )
    parser.add_argument(
        "--pitch", type=within(-90.0, 90.0), default=0.0, metavar="DEG", help="how far its nose points down (0)"
    )
    parser.add_argument(
        "--minutes", type=within(0.01, 60.0), default=7.0, metavar="M", help="cut the drive off (at its end)"
    )


def _record(options: argparse.Namespace) -> int:
    from ...envs.sensors.camera.config import RgbdConfig
    from ..runs.lab_recording import record_lab

    pitch = math.radians(options.pitch)
    camera = RgbdConfig(rate_hz=options.camera_hz, camera_height=options.camera_height, pitch=pitch)
    check_recording(options.file)
    told = record_lab(options.file, options.seed, camera, 60.0 * options.minutes)
    print(f"{told.scans} scans, {told.frames} frames, {told.seconds:.0f} s; wrote {options.file}")
    return 0


def run(options: argparse.Namespace) -> int:
    """Print the table, or check a folder."""
    if options.action == "check":
        return _check(_folder(options.folder), options.only)
    if options.action == "record":
        return _record(options)
    if options.action == "derive":
        return _derive(_folder(options.folder), options.into)
    for each in catalogue():
        print(f"{each.name}\n{_told(each)}\n")
    print("tagalong data check DIR says what of it is in a folder")
    return 0


def _told(collection: Collection) -> str:
    rows = [
        ("rests on it", collection.figures),
        ("recorded by", collection.collector),
        ("origin", collection.origin),
        ("licence", collection.licence),
        ("lies in", f"{', '.join(_folders(collection))} ({len(collection.files)} files)"),
    ]
    return "\n".join(f"  {name + ':':<13}{value}" for name, value in rows)


def _derive(folder: Path, into: Path | None) -> int:
    known = {file.path: file for collection in catalogue() for file in collection.files}
    into, worst = into or folder, 0
    for path in RECIPES:
        told = derive(path, folder, into)
        state = known[path].state_in(into)
        worst = max(worst, int(state != OK))
        print(f"{path}: {told}{'' if state == MISSING else ', ' + state}")
    return worst


def _folders(collection: Collection) -> list[str]:
    return sorted({file.path.rpartition("/")[0] for file in collection.files})


def _folder(given: Path | None) -> Path:
    named = os.environ.get("TAGALONG_DATA")
    folder = given if given is not None else Path(named) if named else None
    if folder is None:
        raise InputError("`tagalong data check` needs a folder: DIR, or the variable TAGALONG_DATA")
    if not folder.is_dir():
        raise InputError(f"{folder}: must be a folder with recordings, is none")
    return folder


def _check(folder: Path, only: str) -> int:
    rows, bad = [], []
    for collection in catalogue():
        states = {file.path: file.state_in(folder) for file in collection.files if file.path.startswith(only)}
        if states:
            counts = Counter(states.values())
            rows.append((collection.name, *(str(counts[state]) for state in (OK, DAMAGED, MISSING))))
        if states and set(states.values()) == {MISSING}:
            bad.append((MISSING, f"all of {collection.name}, in {', '.join(_folders(collection))}"))
        else:
            bad += [(state, path) for path, state in states.items() if state != OK]
    if not rows:
        raise InputError(f"--only {only}: no recording lies there; `tagalong data` lists them")
    print(format_table(("recordings", "ok", "damaged", "missing"), rows))
    for state, path in bad:
        print(f"{state}: {path}")
    return 1 if bad else 0
