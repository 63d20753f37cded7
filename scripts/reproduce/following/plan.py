"""Which cells the experiment consists of."""

from dataclasses import dataclass

from ....agents.tour import SCENES
from ...lab.cells import Cell
from .drives import record_reference, record_tour
from .maps import ENGINES, map_reference, map_tour

FULL_RANGE = 30.0
"""Range of the laser [m]."""
SCANS = ("raw", "filtered")
OFTEN = "gmapping-often"
NO_VOXEL = "cartographer-no-voxel"
REFERENCE_ENGINE = {OFTEN: "gmapping", NO_VOXEL: "cartographer"}
"""Whose map of the slow drive a variant is compared with, where it is not its own."""


@dataclass(frozen=True, kw_only=True)
class ParameterSweep:
    """What the sweep goes through: when does filtering matter?

    Attributes:
        scenes: Buildings.
        odometry: Qualities of the wheel odometry.
        people: Numbers of people, the leader included; 0: the robot drives alone.
        ranges: Usable ranges of the laser [m].
        repeats: Seeds of each.
    """

    scenes: tuple[str, ...] = ("corridor", "plain_corridor")
    odometry: tuple[str, ...] = ("good", "typical", "slipping")
    people: tuple[int, ...] = (0, 1, 2, 4, 8)
    ranges: tuple[float, ...] = (30.0, 8.0, 5.0)
    repeats: int = 3

    def variants(self, odometry: str) -> tuple[str, ...]:
        """Return what maps a drive with this odometry: GMapping with frequent updates only where wheels slip."""
        return (*ENGINES, OFTEN) if odometry == "slipping" else ENGINES


QUICK_SWEEP = ParameterSweep(
    scenes=("plain_corridor",), odometry=("slipping",), people=(0, 2), ranges=(30.0, 8.0), repeats=1
)


def paper_cells(repeats: int) -> list[Cell]:
    """Return the cells of the published experiment, and of its explanations."""
    cells = []
    for scene in SCENES:
        for seed in range(repeats):
            cells += reference_cells(scene, seed)
            for people in (1, 2):
                cells.append(tour_cell(scene, people, "typical", seed))
                cells += [
                    map_cell(scene, people, "typical", FULL_RANGE, variant, scans, seed, keep=seed == 0)
                    for variant in (*ENGINES, NO_VOXEL)
                    for scans in SCANS
                ]
    return cells


def sweep_cells(sweep: ParameterSweep) -> list[Cell]:
    """Return the cells of the sweep; some are also the published experiment's."""
    cells = []
    for scene in sweep.scenes:
        for seed in range(sweep.repeats):
            cells += reference_cells(scene, seed)
            for odometry in sweep.odometry:
                for people in sweep.people:
                    cells.append(tour_cell(scene, people, odometry, seed))
                    cells += [
                        map_cell(scene, people, odometry, usable, variant, scans, seed)
                        for usable in sweep.ranges
                        for variant in sweep.variants(odometry)
                        for scans in SCANS
                    ]
    return cells


def all_cells(repeats: int, sweep: ParameterSweep) -> list[Cell]:
    """Return everything, each cell once; those of the published experiment win, since they keep more."""
    unique: dict[str, Cell] = {}
    for cell in (*paper_cells(repeats), *sweep_cells(sweep)):
        unique.setdefault(cell.name, cell)
    return list(unique.values())


def reference_cells(scene: str, seed: int) -> list[Cell]:
    """Return the slow drive and the maps of it."""
    slow = f"slow/{scene}/s{seed}"
    arguments = {"scene": scene, "seed": seed}
    drive = Cell(name=slow, function=record_reference, arguments=arguments, keeps_files=True)
    maps = [
        Cell(
            name=reference_name(scene, engine, seed),
            function=map_reference,
            arguments={"variant": engine, "seed": seed},
            keeps_files=True,
            needs=(slow,),
        )
        for engine in ENGINES
    ]
    return [drive, *maps]


def reference_name(scene: str, variant: str, seed: int) -> str:
    """Return the name of the cell that maps the slow drive without people."""
    return f"reference/{scene}/{variant}/s{seed}"


def tour_name(scene: str, people: int, odometry: str, seed: int) -> str:
    """Return the name of the cell that drives."""
    return f"tour/{scene}/{people}p/{odometry}/s{seed}"


def tour_cell(scene: str, people: int, odometry: str, seed: int) -> Cell:
    """Return the cell that drives behind a leader, or alone."""
    arguments = {"scene": scene, "people": people, "odometry": odometry, "seed": seed}
    name = tour_name(scene, people, odometry, seed)
    return Cell(name=name, function=record_tour, arguments=arguments, keeps_files=True)


def map_name(scene: str, people: int, odometry: str, usable: float, variant: str, scans: str, seed: int) -> str:
    """Return the name of the cell that maps a tour."""
    return f"map/{scene}/{people}p/{odometry}/{usable:.0f}m/{variant}/{scans}/s{seed}"


def map_cell(
    scene: str, people: int, odometry: str, usable: float, variant: str, scans: str, seed: int, *, keep: bool = False
) -> Cell:
    """Return the cell that maps a tour with a laser of `usable` range [m] and judges the map."""
    engine = REFERENCE_ENGINE.get(variant, variant)
    return Cell(
        name=map_name(scene, people, odometry, usable, variant, scans, seed),
        function=map_tour,
        arguments={"scene": scene, "variant": variant, "scans": scans, "usable_range": usable, "seed": seed},
        keeps_files=keep,
        needs=(
            tour_name(scene, people, odometry, seed),
            f"slow/{scene}/s{seed}",
            reference_name(scene, engine, seed),
        ),
    )
