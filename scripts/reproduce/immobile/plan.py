"""Which drives there are, and what they are called."""

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ...console.arguments import MOST_CELLS, at_least, random_seed, within
from ...lab.cells import Cell
from .drives import MAPPERS, METHOD, POSES, lab_drive

SEEDS, QUICK_SEEDS = 5, 1
CAMERA_HZ, QUICK_CAMERA_HZ = 10.0, 2.0
CLEAN = "as it is"
SHAKEN: dict[str, dict[str, float | str]] = {
    CLEAN: {},
    "vibration 1 deg": {"vibration_deg": 1.0},
    "vibration 2 deg": {"vibration_deg": 2.0},
    "10 % missing depth": {"missing": 0.1},
    "5 % wrong likelihoods": {"wrong": 0.05},
    "camera 20 deg down": {"pitch_deg": 20.0},
    "poses by the map itself": {"poses": "immobile"},
    "both of these": {"pitch_deg": 20.0, "poses": "immobile"},
}
"""Disturbance -> what it changes of `lab_drive`'s arguments."""
QUICK_SHAKEN = (CLEAN, "vibration 2 deg")


@dataclass(frozen=True, kw_only=True)
class ImmobilePlan:
    """What is driven.

    Attributes:
        seeds: Buildings.
        disturbances: Names in `SHAKEN`.
        settings: The other arguments of `lab_drive`.
    """

    seeds: Sequence[int]
    disturbances: Sequence[str]
    settings: dict[str, Any]

    def cells(self) -> list[Cell]:
        """Return a cell for each drive, the undisturbed ones first."""
        calm = {"vibration_deg": 0.0, "pitch_deg": 0.0, "missing": 0.0, "wrong": 0.0}
        return [
            Cell(
                name=cell_name(disturbance, seed),
                function=lab_drive,
                arguments={"seed": seed, **self.settings, **calm, **SHAKEN[disturbance], "ways": ways_of(disturbance)},
                keeps_files=True,
            )
            for disturbance in self.disturbances
            for seed in self.seeds
        ]


def ways_of(disturbance: str) -> list[str]:
    """Return in which ways a drive is mapped: all of the undisturbed one, else only the method and its yardstick."""
    return list(MAPPERS) if disturbance == CLEAN else ["conventional", METHOD]


def cell_name(disturbance: str, seed: int) -> str:
    """Return the name of the cell of one drive."""
    return f"{disturbance.replace(' %', '').replace(' ', '-')}/seed-{seed}"


def add_plan_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare --seeds, --poses, --camera-hz, --delay, --paper, --minutes."""
    parser.add_argument(
        "--seeds", type=at_least(1, MOST_CELLS), metavar="N", help=f"(default: {SEEDS}, quick: {QUICK_SEEDS})"
    )
    parser.add_argument("--first-seed", type=random_seed, default=0, metavar="S", help="(default: %(default)s)")
    parser.add_argument("--poses", choices=POSES, default="gmapping", help="who localises (default: %(default)s)")
    parser.add_argument(
        "--camera-hz", type=within(0.1, 1000.0), metavar="F", help="frames a second (default: 10, quick: 2)"
    )
    parser.add_argument(
        "--delay", type=within(0.0, 60.0), default=0.3, metavar="S", help="of views [s] (default: %(default)s)"
    )
    parser.add_argument(
        "--paper", action="store_true", help="the paper's robot and camera: a Pioneer 3-DX, 512 x 424 pixels"
    )
    parser.add_argument(
        "--minutes", type=within(0.1, 1440.0), metavar="M", help="cut the drive off (default: at its end)"
    )


def plan_of(options: argparse.Namespace) -> ImmobilePlan:
    """Return the plan that the options ask for."""
    count = options.seeds if options.seeds is not None else QUICK_SEEDS if options.quick else SEEDS
    hz = options.camera_hz if options.camera_hz is not None else QUICK_CAMERA_HZ if options.quick else CAMERA_HZ
    longest = None if options.minutes is None else 60.0 * options.minutes
    settings = {"poses": options.poses, "camera_hz": hz, "delay_s": options.delay, "longest_s": longest}
    return ImmobilePlan(
        seeds=range(options.first_seed, options.first_seed + count),
        disturbances=QUICK_SHAKEN if options.quick else tuple(SHAKEN),
        settings=settings | ({"paper": True} if options.paper else {}),
    )
