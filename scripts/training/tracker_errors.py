"""`tagalong train tracker-errors`: the numbers of `people="modelled"`, fitted to drives and checked on others."""

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ...envs.tracker_errors.errors import SHIPPED, named
from ...slam.files.output import made_folder, write_json
from ..console.arguments import at_least
from ..console.subcommands import add_described
from ..console.tables import format_table
from .tracker_check import compare
from .tracker_drives import DriveSetting, record_drives
from .tracker_fit import fit_errors

EPILOG = """\
A PID follower drives, people known by the real leg detector and tracker; then in settings, with seeds and a laser
that nothing was fitted to, once by the tracker and once by the model.

writes into DIR: tracker_errors.json (the numbers, what they were fitted to, and the check)

examples:
  tagalong train tracker-errors --out out/tracker-errors
  tagalong evaluate pid --perception modelled --set tracker_errors=out/tracker-errors/tracker_errors.json
"""
FIRST_FITTED = 20_000
"""Seeds of fitted drives begin here."""
FIRST_CHECKED = 70_000
"""And those of the check here."""
_FITTED: tuple[tuple[str, dict[str, Any]], ...] = (
    ("Office", {"people_count": 6}),
    ("Office", {"people_count": 10}),
    ("Corridor", {"people_count": 3}),
    ("MeetingRoom", {"people_count": 3}),
    ("FloorPlan", {"people_count": 6}),
)
FITTED = tuple(
    DriveSetting(
        name=f"{env}, {arguments['people_count']} people, {beams} beams",
        env=env,
        arguments={**arguments, "beams": beams},
    )
    for beams in (360, 1081)
    for env, arguments in _FITTED
)
"""What the numbers are fitted to."""
_CHECKED: tuple[tuple[str, dict[str, Any]], ...] = (
    ("Office", {"split": "test", "people_count": 6}),
    ("Office", {"split": "test", "people_count": 10}),
    *(
        ("Office", {"scene": name, "people_count": 9})
        for name in ("narrow_corridor", "doorway", "intersection", "clutter")
    ),
)
CHECKED = tuple(
    DriveSetting(name=f"{arguments.get('scene', env)}, {arguments['people_count']} people", env=env,
              arguments={**arguments, "beams": 720})
    for env, arguments in _CHECKED
)  # fmt: skip
"""What they are checked on: other buildings, other seeds, a laser of other resolution."""


def add_tracker_arguments(models: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Declare the options."""
    summary = 'what leg detector and tracker get wrong, for people="modelled"'
    parser = add_described(models, "tracker-errors", summary, EPILOG)
    for name, default, what in (
        ("seeds", 8, "drives in each setting that is fitted to"),
        ("check-seeds", 10, "drives in each setting of the check"),
        ("steps", 900, "most control periods of a drive"),
    ):
        parser.add_argument(
            f"--{name}", type=at_least(1, 100_000), default=default, metavar="N", help=f"{what} (default: %(default)s)"
        )
    parser.add_argument("--out", type=Path, default=Path("out/tracker-errors"), metavar="DIR", help="%(default)s")


def train_tracker_errors(options: argparse.Namespace) -> int:
    """Drive, fit, drive again with and without the model, print and write the comparison."""
    seeds = range(FIRST_FITTED, FIRST_FITTED + options.seeds)
    fitted = record_drives(FITTED, seeds, options.steps, people="tracker")
    path = made_folder(options.out) / SHIPPED.name
    card: dict[str, Any] = {
        "command": f"tagalong train tracker-errors --seeds {options.seeds} --check-seeds {options.check_seeds} "
        f"--steps {options.steps}",
        "errors": named(fit_errors(fitted)),
        "fitted_to": _told(FITTED, seeds, sum(len(drive.phase) for drive in fitted)),
    }
    write_json(path, card)
    seeds = range(FIRST_CHECKED, FIRST_CHECKED + options.check_seeds)
    real = record_drives(CHECKED, seeds, options.steps, people="tracker")
    modelled = record_drives(CHECKED, seeds, options.steps, people="modelled", tracker_errors=str(path))
    rows = compare(real, modelled)
    told = [(row["statistic"], row["real"].text(digits=3), row["modelled"].text(digits=3), "" if row["agree"] else "no")
            for row in rows]  # fmt: skip
    print(format_table(("on drives not fitted", "real tracker", "model", "agree"), told))
    card["checked_on"] = _told(CHECKED, seeds, sum(len(drive.phase) for drive in real))
    card["check"] = {
        row["statistic"]: {"real": row["real"].to_dict(), "modelled": row["modelled"].to_dict(), "agree": row["agree"]}
        for row in rows
    }
    write_json(path, card)
    print(f"wrote {path}")
    return 0


def _told(settings: Sequence[DriveSetting], seeds: range, scans: int) -> dict[str, Any]:
    names = [setting.name for setting in settings]
    return {"follower": "pid", "settings": names, "seeds": [seeds.start, seeds.stop - 1], "scans": scans}
