"""`tagalong reproduce following`: the experiment as cells and a report."""

import argparse
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from ....slam.errors import InputError
from ...console.arguments import MOST_CELLS, at_least
from ...figures.plots import require_matplotlib
from ...lab.cells import Cell
from ..report import Report, Section
from .pictures import draw_boxes, draw_overlays, draw_scan, draw_scenes
from .plan import QUICK_SWEEP, ParameterSweep, all_cells
from .sweep import SweepResults, draw_heat_maps, sweep_section
from .tables import (
    PaperResults,
    explanation_table,
    following_table,
    lead,
    metrics_table,
    paper_table,
    verdict_table,
)

EPILOG = """\
Mapping behind a leader as in Ye et al. 2021, III: {corridor, meeting room} x {1, 2 people} x {GMapping, Cartographer's
kind} x {raw, filtered}, each drive mapped from its raw and its filtered scans and compared with the slow drive of the
empty building; then the sweep: usable range x odometry x number of people.

example:
  tagalong reproduce following --repeats 5 --jobs 2 --out out/following
  tagalong reproduce following --quick --jobs 2 --out out/following-quick
"""
REPEATS, QUICK_REPEATS = 5, 2


class Following:
    """The experiment (`Experiment` of the frame)."""

    name = "following"

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        """Declare --repeats and --no-sweep."""
        parser.epilog = EPILOG
        parser.add_argument(
            "--repeats", type=at_least(1, MOST_CELLS), metavar="N", help=f"(default: {REPEATS}, quick: {QUICK_REPEATS})"
        )
        parser.add_argument("--no-sweep", action="store_true", help="the published experiment only")

    def cells(self, options: argparse.Namespace) -> Sequence[Cell]:
        """Return every cell.

        Raises:
            InputError: If --repeats is below 1.
            MissingExtraError: If the report could not be drawn in the end.
        """
        require_matplotlib()
        return all_cells(_repeats(options), _sweep(options))

    def report(self, results: Mapping[str, Any], options: argparse.Namespace, folder: Path) -> Report:
        """Judge and draw."""
        repeats, cells = _repeats(options), options.out / "cells"
        paper = PaperResults(results, repeats)
        sections = [
            Section(
                title="The published experiment",
                text=_METHOD,
                tables=[paper_table(paper), verdict_table(paper), metrics_table(paper), following_table(paper)],
                figures=[
                    draw_scenes(cells, folder),
                    draw_scan(cells, folder),
                    draw_overlays("corridor", cells, folder),
                    draw_overlays("meeting_room", cells, folder),
                    draw_boxes(paper, folder),
                ],
            ),
            Section(title="The paper's explanations", text=_EXPLANATIONS, tables=[explanation_table(paper)]),
        ]
        numbers: dict[str, Any] = {"published": paper.numbers()}
        sweep = _sweep(options)
        if sweep.repeats:
            swept = SweepResults(results, sweep)
            sections.append(sweep_section(swept, draw_heat_maps(swept, folder)))
            numbers |= {"sweep": swept.numbers(), "sweep_extent": asdict(sweep)}
        return Report(title="Mapping while following", lead=lead(paper), sections=sections, results=numbers)


_METHOD = """\
Every drive is mapped twice by the same engine, from its raw scans and from its scans without people, with cells of
0.02 m, and compared with that engine's map of a slow drive (0.3 m/s) through the same building without people, as in
the paper: registration by PCA and ICP, then ADNN by equation 7 (reference to map). Each seed is another building,
leader and error of the odometry. With 2 people, both walk in front of the robot. Intervals are Student's
95 % ones over the repeats.

The paper's drives were real, with 40 scans a second and with people, robot and floor of its own; ours are simulated at
10 scans a second. What is compared is the effect of filtering, not the centimetre.
"""
_EXPLANATIONS = """\
The paper explains what it saw in three ways. Its voxel filter is said to make Cartographer robust: we match every
point instead (adaptive voxel filter off). Raw maps are said to show walls twice: cells of the map that lie farther
than 6 cm from any true surface. And raw maps of the meeting room are said to lack edges of the table: the share of
true cells around it (legs and chairs) that the map shows.
"""


def _repeats(options: argparse.Namespace) -> int:
    repeats = options.repeats if options.repeats is not None else QUICK_REPEATS if options.quick else REPEATS
    if repeats < 1:
        raise InputError(f"--repeats must be at least 1, got {repeats}")
    return repeats


def _sweep(options: argparse.Namespace) -> ParameterSweep:
    sweep = QUICK_SWEEP if options.quick else ParameterSweep()
    return replace(sweep, repeats=0) if options.no_sweep else sweep


EXPERIMENT = Following()
