"""`tagalong doctor`: says what is installed and what works here."""

import argparse
import platform

from ... import __version__
from ..console.first_call import HINT, kernels_are_kept
from ..console.tables import format_table
from ..runs.diagnosis import (
    CORE,
    EXTRAS,
    OPENGL_REMEDIES,
    Check,
    check_drive,
    check_extras,
    check_opengl,
    check_surroundings,
    installed_version,
)

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
    core = [(name, found or "MISSING", "" if found else f"pip install {name}") for name, found in versions.items()]
    print(format_table(("core", "version", "what to do"), core))
    print()
    print(format_table(("extra", "installed", "what to do"), [_extra_row(check) for check in check_extras()]))
    print()
    rows = [(check.name, _yes(check.works), check.note) for check in check_surroundings()]
    print(format_table(("around it", "there", "what to do"), rows))
    print()
    if not options.no_opengl:
        _print_opengl(check_opengl())
    if not kernels_are_kept():
        print(f"{HINT} ...", flush=True)
    drive = check_drive()
    print(f"self-test: {drive.name}: {'ok' if drive.works else 'FAILED'} ({drive.note})")
    if not drive.works:
        print(
            "the core does not work as it should: install anew into an empty environment (python -m venv), and if that"
        )
        print("does not help, report this whole output")
    return 0 if drive.works and all(versions.values()) else 1


def _extra_row(check: Check) -> tuple[str, str, str]:
    count = len(EXTRAS[check.name])
    missing = len(check.note.split(", ")) if check.note else 0
    remedy = "" if check.works else f'pip install "tagalong[{check.name}]"'
    state = "yes" if check.works else ("no" if missing == count else f"partly, without {check.note}")
    return check.name, state, remedy


def _print_opengl(checks: list[Check]) -> None:
    """Print which back ends work, and what to do about the others: nothing, if one does."""
    one = next((check.name for check in checks if check.works), None)
    rows = [(check.name, _yes(check.works), check.note, _remedy(check, one)) for check in checks]
    print(format_table(("OpenGL", "works", "reason", "what to do"), rows))
    print("(needed only for MuJoCo's camera and viewer; the top view is drawn without)\n")


def _remedy(check: Check, one: str | None) -> str:
    if check.works:
        return f"MUJOCO_GL={check.name}"
    return f"nothing: {one} works" if one else OPENGL_REMEDIES.get(check.name, "")


def _yes(works: bool) -> str:
    return "yes" if works else "no"
