"""Which cells the experiment has."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ....slam.scan_to_scan import MATCHERS
from ...lab.cells import Cell
from ...lab.scan_pairs import VIEWS
from .contestants import FAMILY, MAIN, PLAIN, SIMULATED, SUFFIX, logs_in
from .degenerate import degenerate
from .real_pairs import AT_TRUTH, consecutive, known_rooms, views
from .searches import ALGORITHMS, exact, example, genetic_search
from .success import corridor, success

ANY = None
GRID_MATCHERS = (*FAMILY, "mbicp", PLAIN, "global")
POLISHED = tuple(name + SUFFIX for name in FAMILY)
NOISES = (0.01, 0.03, 0.1, 0.2)
PEOPLE = (1, 2, 4, 8)
AXIS_MATCHERS = (*FAMILY, "mbicp", "global")
POINTS: tuple[tuple[float, float | None], ...] = ((0.57, 20.0), (2.12, ANY))
"""The paper's two points: translation [m] and rotation [deg] of the guess's error."""
PATH = ((0.07, 2.5), (0.14, 5.0), (0.28, 10.0), (0.42, 15.0), (0.57, 20.0), (0.85, 30.0))
"""From a small to a large error of the guess, for the iterations of MbICP."""
CONFIGURATIONS = {
    "small": ((10, 3), (10, 5), (20, 6), (30, 8), (50, 10), (80, 12), (120, 15), (200, 20)),
    "large": ((20, 6), (50, 8), (100, 10), (150, 12), (200, 12), (400, 12), (600, 16), (1000, 20)),
}
"""Search space -> (population, generations)."""
DISTANCES = ((0.0, 0.3), (0.3, 0.6), (0.6, 1.0), (1.0, 1.5), (1.5, 2.0))
TURNS = ((0.0, 45.0), (45.0, 90.0), (90.0, 180.0))
PAIR_MATCHERS = (AT_TRUTH, "plicp", "mbicp", *FAMILY, "global")
VIEW_MATCHERS = (AT_TRUTH, "plicp", "hglasm-g-large", "global")
ROOM_MATCHERS = ("plicp", "icp", "mbicp")


@dataclass(frozen=True, kw_only=True)
class Extent:
    """How much is computed.

    Attributes:
        rotations: Of the guess's error, in the grid of Figs. 7 and 8 [deg].
        translations: Of the guess's error, in that grid [m].
        trials: A cell.
        point_trials: At the paper's two points.
        exact_trials: Of the exact search, over all logs.
        pairs: Real pairs a cell.
        near_pairs: Real pairs a cell, of views that differ little: two matchers are compared on them.
        consecutive: Consecutive scans a log.
        step: Of the genetic configurations, 1: all.
    """

    rotations: tuple[float, ...] = (0.0, 20.0, 40.0, 60.0, 80.0, 110.0, 140.0, 180.0)
    translations: tuple[float, ...] = (0.0, 0.28, 0.57, 1.13, 2.12)
    trials: int = 500
    point_trials: int = 1000
    exact_trials: int = 200
    pairs: int = 300
    near_pairs: int = 1000
    consecutive: int = 400
    step: int = 1


QUICK = Extent(
    rotations=(0.0, 20.0, 60.0, 110.0, 180.0),
    translations=(0.0, 0.57, 2.12),
    trials=60,
    point_trials=200,
    exact_trials=12,
    pairs=60,
    near_pairs=60,
    consecutive=100,
    step=2,
)


@dataclass(frozen=True)
class MatchingPlan:
    """What is computed from which scans.

    Attributes:
        extent: How much.
        logs: Folder of the logs; None: there are none.
        pairs_file: Pairs of simulated rooms with known poses; None: there are none.
    """

    extent: Extent
    logs: Path | None
    pairs_file: Path | None

    @property
    def sources(self) -> tuple[str, ...]:
        """The scans of the main experiments: logs where there are some, else simulated ones."""
        return logs_in(self.logs, MAIN) or (SIMULATED,)

    @property
    def views(self) -> tuple[str, ...]:
        """The logs with corrected poses that are at hand."""
        return tuple(name for name, file in VIEWS.items() if self.logs is not None and (self.logs / file).is_file())

    def cells(self) -> list[Cell]:
        """Return every cell."""
        return [
            *self._points(),
            *self._grid(),
            *self._axes(),
            *self._searches(),
            *self._corridors(),
            *self._pairs(),
            *self._checks(),
        ]

    def _success(self, matcher: str, at: tuple[float, float | None], trials: int, **more: Any) -> Cell:
        simulated = more.pop("simulated", False) or self.sources == (SIMULATED,)
        arguments = {
            "folder": None if simulated else str(self.logs),
            "sources": [SIMULATED] if simulated else list(self.sources),
            "matcher": matcher,
            "translation": at[0],
            "rotation": at[1],
            "trials": trials,
            **more,
        }
        name = success_name(matcher, at, trials, simulated=simulated, **more)
        return Cell(name=name, function=success, arguments=arguments)

    def _points(self) -> list[Cell]:
        kinds = (False, True) if self.sources != (SIMULATED,) else (True,)
        return [
            self._success(matcher, at, self.extent.point_trials, simulated=simulated)
            for simulated in kinds
            for matcher in (*GRID_MATCHERS, *POLISHED)
            for at in POINTS
        ]

    def _grid(self) -> list[Cell]:
        extent = self.extent
        errors = {(t, r) for t in extent.translations for r in extent.rotations} | set(PATH)
        return [self._success(m, at, extent.trials) for m in GRID_MATCHERS for at in sorted(errors)]

    def _axes(self) -> list[Cell]:
        trials = self.extent.trials
        return [
            *(self._success(m, POINTS[0], trials, noise=noise) for m in AXIS_MATCHERS for noise in NOISES),
            *(self._success(m, POINTS[0], trials, people=people) for m in AXIS_MATCHERS for people in PEOPLE),
        ]

    def _searches(self) -> list[Cell]:
        return [
            Cell(
                name=search_name(algorithm, space, population, generations),
                function=genetic_search,
                arguments={
                    **self._scans(),
                    "algorithm": algorithm,
                    "space": space,
                    "population": population,
                    "generations": generations,
                    "trials": self.extent.trials,
                },
            )
            for space, configurations in self.configurations.items()
            for algorithm in ALGORITHMS
            for population, generations in configurations
        ] + [self._table_one(size) for size in TABLE_ONE]

    def _table_one(self, size: str) -> Cell:
        population, generations, runs = TABLE_ONE[size]
        question = {"algorithm": "glasm-g", "space": size, "population": population, "generations": generations}
        arguments = {**self._scans(), **question, "runs": runs, "trials": self.extent.trials}
        return Cell(name=f"table-1/{size}", function=genetic_search, arguments=arguments)

    @property
    def configurations(self) -> dict[str, tuple[tuple[int, int], ...]]:
        """Search space -> (population, generations) of the genetic searches."""
        return {space: pairs[:: self.extent.step] for space, pairs in CONFIGURATIONS.items()}

    def _scans(self) -> dict[str, Any]:
        simulated = self.sources == (SIMULATED,)
        return {"folder": None if simulated else str(self.logs), "sources": list(self.sources)}

    def _corridors(self) -> list[Cell]:
        logs = logs_in(self.logs)
        common = {"folder": str(self.logs), "sources": list(logs), "trials": self.extent.trials}
        return [
            Cell(
                name=corridor_name(matcher, at),
                function=corridor,
                arguments={**common, "matcher": matcher, "translation": at[0], "rotation": at[1]},
            )
            for matcher in AXIS_MATCHERS
            for at in POINTS
            if logs
        ]

    def _pairs(self) -> list[Cell]:
        made = []
        common = {"folder": str(self.logs), "pairs": self.extent.pairs}
        if "intel" in self.views:
            still = {**common, "building": "intel", "turns": [0.0, 45.0], "guess": "none"}
            for matcher in PAIR_MATCHERS:
                for reach in DISTANCES:
                    arguments = {**still, "matcher": matcher, "distances": list(reach)}
                    made.append(Cell(name=distance_name(matcher, reach), function=views, arguments=arguments))
        for building in self.views:
            wrong = {**common, "building": building, "distances": [0.2, 2.0], "guess": "wrong"}
            for matcher in VIEW_MATCHERS:
                for turns in TURNS:
                    arguments = {**wrong, "matcher": matcher, "turns": list(turns)}
                    if turns == TURNS[0]:
                        arguments["pairs"] = self.extent.near_pairs
                    made.append(Cell(name=view_name(building, matcher, turns), function=views, arguments=arguments))
        return made

    def _checks(self) -> list[Cell]:
        extent, sources = self.extent, self.sources
        folder = self._scans()["folder"]
        made = [
            Cell(name=f"degenerate/{m}", function=degenerate, arguments={"matcher": m, "trials": 10}) for m in MATCHERS
        ]
        for source in sources:
            arguments = {"folder": folder, "source": source, "trials": extent.exact_trials // len(sources)}
            made.append(Cell(name=f"exact/{source}", function=exact, arguments=arguments))
        shown = {"folder": folder, "source": sources[0], "scan": 2000, "guess": [1.2, -0.9, 1.9]}
        made.append(Cell(name="example", function=example, arguments=shown))
        for source in sources if folder is not None else ():
            for matcher in ("plicp", "mbicp"):
                drive = {"folder": folder, "building": source, "matcher": matcher, "scans": extent.consecutive}
                made.append(Cell(name=f"consecutive/{source}/{matcher}", function=consecutive, arguments=drive))
        for matcher in ROOM_MATCHERS if self.pairs_file is not None else ():
            rooms = {"file": str(self.pairs_file), "matcher": matcher, "repeats": 3}
            made.append(Cell(name=f"rooms/{matcher}", function=known_rooms, arguments=rooms))
        return made


TABLE_ONE = {"small": (20, 6, 1), "medium": (100, 10, 1), "large": (200, 12, 2)}
"""Table 1: population, generations, runs."""


def success_name(
    matcher: str,
    at: tuple[float, float | None],
    trials: int,
    *,
    simulated: bool = False,
    noise: float = 0.0,
    people: int = 0,
) -> str:
    """Return the name of a cell of `success`."""
    place = "simulated" if simulated else "logs"
    disturbed = f"-noise-{noise:g}" if noise else f"-people-{people}" if people else ""
    turn = "any" if at[1] is None else f"{at[1]:g}"
    return f"success/{place}{disturbed}/{matcher}/{at[0]:g}-{turn}-{trials}"


def search_name(algorithm: str, space: str, population: int, generations: int) -> str:
    """Return the name of a cell of `genetic_search`."""
    return f"search/{space}/{algorithm}/{population}-{generations}"


def corridor_name(matcher: str, at: tuple[float, float | None]) -> str:
    """Return the name of a cell of `corridor`."""
    return f"corridor/{matcher}/{at[0]:g}-{'any' if at[1] is None else f'{at[1]:g}'}"


def distance_name(matcher: str, reach: Sequence[float]) -> str:
    """Return the name of a cell of `views` at growing distances."""
    return f"distance/{matcher}/{reach[0]:g}-{reach[1]:g}"


def view_name(building: str, matcher: str, turns: Sequence[float]) -> str:
    """Return the name of a cell of `views` at growing turns."""
    return f"views/{building}/{matcher}/{turns[0]:g}-{turns[1]:g}"
