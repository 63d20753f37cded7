"""`tagalong doctor`: says what is installed and what works here."""

import argparse
import platform

from ... import __version__
from ..console.tables import format_table
from ..runs.diagnosis import CORE, EXTRAS, Check, check_drive, check_extras, check_opengl, installed_version

EPILOG = """\
exits with 0 when the core works, with 1 when it does not; extras and OpenGL are not needed for the core:
pictures and videos of the top view are drawn without OpenGL.

example:
  tagalong doctor
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.epilog = EPILOG
    parser.add_argument("--no-opengl", action="store_true", help="do not try the OpenGL back ends")


def run(options: argparse.Namespace) -> int:
    """Print the findings."""
    print(f"tagalong {__version__}, Python {platform.python_version()}, {platform.system()} {platform.machine()}\n")
    versions = {name: installed_version(name) for name in CORE}
    print(format_table(("core", "version"), [(name, found or "MISSING") for name, found in versions.items()]))
    print()
    print(format_table(("extra", "installed", "remedy"), [_extra_row(check) for check in check_extras()]))
    print()
    if not options.no_opengl:
        rows = [(check.name, _yes(check.works), check.note) for check in check_opengl()]
        print(format_table(("OpenGL", "works", "reason"), rows))
        print("(needed only for MuJoCo's camera and viewer: set MUJOCO_GL to one that works)\n")
    drive = check_drive()
    print(f"self-test: {drive.name}: {'ok' if drive.works else 'FAILED'} ({drive.note})")
    return 0 if drive.works and all(versions.values()) else 1


def _extra_row(check: Check) -> tuple[str, str, str]:
    count = len(EXTRAS[check.name])
    missing = len(check.note.split(", ")) if check.note else 0
    remedy = "" if check.works else f'pip install "tagalong[{check.name}]"'
    state = "yes" if check.works else ("no" if missing == count else f"partly, without {check.note}")
    return check.name, state, remedy


def _yes(works: bool) -> str:
    return "yes" if works else "no"
