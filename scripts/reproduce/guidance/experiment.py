"""`tagalong reproduce guidance`: all guides in the same buildings, as cells and a report."""

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ....agents import make_follower
from ....slam.errors import InputError
from ...console.arguments import MOST_CELLS, at_least, within
from ...figures.plots import require_matplotlib
from ...lab.cells import Cell
from ..report import Report, Section
from .drives import GUIDES, SCENES, UNLED, guide_drive
from .measured import Measured, cell_name
from .pictures import draw_coverage, draw_criteria, videos
from .tables import figures_table, lead, numbers, scenes_table, signs_table

EPILOG = """\
Every guide maps the same buildings among the same bystanders: people following (pid, pure_pursuit, dwa, the
reinforced network, a planner that looks for what its map lacks), joystick (an operator model, not a human), random and
frontier exploration. At most eight simulated minutes each.

example:
  tagalong reproduce guidance --jobs 2 --out out/guidance
  tagalong reproduce guidance --quick --jobs 2 --out out/guidance-quick
  tagalong reproduce guidance --also my_module:Bold --jobs 2 --out out/guidance
"""
REPEATS, QUICK_REPEATS = 30, 3
LIMIT_S, QUICK_LIMIT_S = 480.0, 240.0
VIDEO_SCENE = "corridor"


class Guidance:
    """The experiment (`Experiment` of the frame)."""

    name = "guidance"

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        """Declare --repeats, --also and --minutes."""
        parser.epilog = EPILOG
        parser.add_argument(
            "--repeats", type=at_least(1, MOST_CELLS), metavar="N", help=f"(default: {REPEATS}, quick: {QUICK_REPEATS})"
        )
        parser.add_argument(
            "--also", nargs="+", default=[], metavar="WHO", help="further followers, by name or as module:class"
        )
        parser.add_argument(
            "--minutes", type=within(0.1, 1440.0), metavar="M", help="simulated minutes (default: 8, quick: 4)"
        )

    def cells(self, options: argparse.Namespace) -> Sequence[Cell]:
        """Return every cell.

        Raises:
            InputError: If an option is wrong.
            MissingExtraError: If the report could not be drawn in the end.
        """
        require_matplotlib()
        limit = _limit_s(options)
        return [
            Cell(
                name=cell_name(guide, scene, seed),
                function=guide_drive,
                arguments={"guide": guide, "scene": scene, "seed": seed, "limit_s": limit},
                keeps_files=scene == VIDEO_SCENE and seed == 0,
            )
            for seed in range(_repeats(options))
            for scene in SCENES
            for guide in reversed(_guides(options))
        ]

    def report(self, results: Mapping[str, Any], options: argparse.Namespace, folder: Path) -> Report:
        """Judge and draw."""
        measured = Measured(results, tuple(SCENES), range(_repeats(options)), _limit_s(options), _guides(options))
        sections = [
            Section(
                title="Table I, measured",
                text=_METHOD,
                tables=[signs_table(measured), scenes_table(measured)],
                figures=[draw_criteria(measured, folder), draw_coverage(measured, folder)],
            ),
            Section(
                title="All figures",
                text=_FIGURES,
                tables=[figures_table(measured, scene) for scene in SCENES],
            ),
            Section(
                title="One drive of each guide",
                text="The first minute of the same seed.",
                figures=videos(_guides(options), VIDEO_SCENE, 0, options.out / "cells", folder),
            ),
        ]
        return Report(
            title="Following against joystick against exploration",
            lead=lead(measured),
            sections=sections,
            results=numbers(measured),
        )


_METHOD = """\
Every seed is one building, one set of bystanders (two who walk, one who comes to stand) and one error of the odometry,
the same for all guides; those who follow get a leader besides, who walks a tour of the building. The joystick drives
that tour: an operator model, not a human, recorded in the closed loop and replayed in the open loop. Explorers know
nothing and stop when 99 % of the floor was seen. Contacts are counted and end nothing. Everybody maps with graph SLAM
on scans without people.

The rule: a guide gets one plus sign, and one more for each of the two others that it is significantly better than
(Wilcoxon's signed ranks over the same buildings, p < 0.05 after Holm's correction over the three pairs). What decides:
convenience - the operator's commands, and at equal commands the time in which the operator is busy (leading counts);
time saving - the time until 90 % of the floor was seen from 4.6 m or nearer, the time limit where that never happened;
motion smoothness - RMS jerk; safety - contacts with people and things and near misses (less than 0.25 m from a
bystander) in the whole job.

The verdict: a cell of the paper's table says how its guide stands to the two others. It is confirmed if both relations
hold here, refuted if one is contradicted by a significant difference, not separable otherwise. Equal signs hold if the
95 % interval of the ratio of the means lies within 0.8 and 1.25.
"""
_FIGURES = """\
Floor seen: from where the robot truly was, beams that met no people. Map: the robot's own, at the end of the drive,
against the true building, after registration. Jerk of the true speed, low-passed at 2 Hz without phase; SPARC and LDLJ
over windows of 10 s.
"""


def _guides(options: argparse.Namespace) -> tuple[str, ...]:
    """Return who drives.

    Raises:
        InputError: If somebody further is unknown or explores.
    """
    for name in options.also:
        if name in UNLED:
            raise InputError(f"--also takes followers, {name!r} follows nobody")
        make_follower(name)
    return tuple(dict.fromkeys((*GUIDES, *options.also)))


def _repeats(options: argparse.Namespace) -> int:
    repeats = options.repeats if options.repeats is not None else QUICK_REPEATS if options.quick else REPEATS
    if repeats < 2:
        raise InputError(f"--repeats must be at least 2, got {repeats}")
    return repeats


def _limit_s(options: argparse.Namespace) -> float:
    minutes = options.minutes
    limit = 60.0 * minutes if minutes is not None else QUICK_LIMIT_S if options.quick else LIMIT_S
    return round(limit, 1)


EXPERIMENT = Guidance()
