"""`tagalong reproduce immobile`: drives through the lab as cells, figures 1 to 9 and the numbers as a report."""

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ...figures.plots import require_matplotlib
from ...lab.cells import Cell, files_of
from ..report import Report, Section
from . import sensors, tables
from .counted import Counted
from .drives import lab_world
from .maps import DriveMaps
from .plan import CLEAN, add_plan_arguments, cell_name, plan_of

EPILOG = """\
An operator drives a robot with laser and RGB-D camera twice round a lab full of furniture and people, and out into a
passage: about five minutes. The same sensor data are mapped in several ways on the same poses, with and without
disturbances.

example:
  tagalong reproduce immobile --jobs 2 --out out/immobile
  tagalong reproduce immobile --quick --out out/immobile-quick
  tagalong reproduce immobile --paper --out out/immobile-paper
"""


class Immobile:
    """The experiment (`Experiment` of the frame)."""

    name = "immobile"

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        """Declare --seeds, --first-seed, --poses, --camera-hz, --delay, --paper and --minutes."""
        parser.epilog = EPILOG
        add_plan_arguments(parser)

    def cells(self, options: argparse.Namespace) -> Sequence[Cell]:
        """Return every cell.

        Raises:
            InputError: If an option is wrong.
            MissingExtraError: If the report could not be drawn in the end.
        """
        require_matplotlib()
        return plan_of(options).cells()

    def report(self, results: Mapping[str, Any], options: argparse.Namespace, folder: Path) -> Report:
        """Judge and draw."""
        plan = plan_of(options)
        counted = Counted(results, plan.seeds)
        drives = [_maps_of(seed, options.out) for seed in plan.seeds]
        for seed, drive in zip(plan.seeds, drives, strict=True):
            drive.export(options.out / "maps", f"seed-{seed}")
        maps = drives[0]
        sections = [
            Section(
                title="The update",
                tables=[tables.decision_table()],
                figures=[sensors.draw_curves(folder), sensors.draw_ranges(folder)],
            ),
            Section(
                title="What the sensors see",
                figures=[
                    sensors.draw_scene(maps.exhibit, folder),
                    sensors.draw_planes(maps.exhibit, folder),
                    maps.draw_desk(folder),
                    maps.draw_integrated(folder),
                ],
            ),
            Section(
                title="The laboratory",
                text=_METHOD,
                tables=[tables.claims_table(counted), tables.door_table(counted), tables.seeds_table(counted)],
                figures=[maps.draw_plan(folder), maps.draw_both(folder)],
            ),
            Section(
                title="Disturbed sensors",
                text=_SHAKEN,
                tables=[
                    tables.disturbed_table(counted, plan.disturbances),
                    tables.doubled_table(counted, [name for name in plan.disturbances if name != CLEAN]),
                ],
            ),
        ]
        return Report(
            title="Immobile-area mapping with laser and RGB-D camera",
            lead=tables.lead(counted),
            sections=sections,
            results=tables.numbers(counted, plan.disturbances),
        )


def _maps_of(seed: int, out: Path) -> DriveMaps:
    """Return the maps of the undisturbed drive of `seed`."""
    world = lab_world(seed)
    return DriveMaps(files_of(cell_name(CLEAN, seed), out / "cells"), world.scene, np.array(world.start))


_METHOD = """\
Two people stand still all the time (d); one stands near the door, opens it and walks out (e to f); one walks in the
passage and stops (g). Four maps are drawn of the same drive on the same poses: the conventional occupancy grid by the
laser; immobile area by the laser alone; by laser and camera; and the same with people told by the simulator, an upper
bound. In all but the first, legs that the tracker knows are people. Views are written 0.3 s after their exposure,
where the robot was at the exposure.
"""
_SHAKEN = """\
Vibration turns the camera by a random pitch and roll in each frame, with this standard deviation. Wrong likelihoods:
in each frame, each plane and each person has its likelihood l taken for 1 - l with this probability. The last three
rows are no disturbances: a camera that looks down, poses by the map itself (each scan is matched on the laser's layer
that the scans before it drew), and both together.
"""

EXPERIMENT = Immobile()
