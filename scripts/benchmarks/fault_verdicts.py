"""What the robustness bench asks of the engines, and which cells miss it."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from ..lab.cells import TIMING
from .fault_scores import OFF, STRETCH

GRAPH, RIVAL, WITHOUT = "cartographer", "gmapping", "cartographer without recovery"
SMALL = 0.3
"""An error up to here is no failure, whatever others reach [m]."""
WORSE_THAN_RIVAL, WORSE_THAN_UNDISTURBED = 2.0, 3.0
WITHIN, TOLD, WRONGLY_TOLD = 0.95, 0.95, 0.02
NOISE, NOISE_SHARE = 0.05, 0.1
"""Recovery is worse than none where its error is larger by more than 0.05 m and by more than a tenth: less comes of any
change, as another order of additions."""


@dataclass(frozen=True, kw_only=True)
class FaultyCell:
    """What an engine made of a drive with a fault.

    Attributes:
        drive: Name of the drive.
        fault: Name of the fault.
        engine: Name of the engine.
        error: The error at the end [m]; inf where the engine failed.
        plain: That of the same engine on the same drive without a fault [m].
        result: Everything else, as of `slam_faults.faulty`.
    """

    drive: str
    fault: str
    engine: str
    error: float
    plain: float
    result: Mapping[str, Any]

    @property
    def name(self) -> str:
        """Drive and fault."""
        return f"{self.drive}/{self.fault}"

    @property
    def failed(self) -> str | None:
        """With what the engine ended instead of a trajectory."""
        return self.result.get("failed")

    @property
    def processor_s(self) -> float:
        """Time of processor that the engine took [s]."""
        return self.result.get(TIMING, {}).get("processor_s", math.nan)


@dataclass(frozen=True, kw_only=True)
class FaultVerdict:
    """Whether what is asked for holds.

    Attributes:
        asks: What is asked for.
        holds: Whether it is so.
        found: What was found, in a few words.
        missed: The cells that miss it, with their figures, the worst first.
    """

    asks: str
    holds: bool
    found: str
    missed: Sequence[str]

    def to_dict(self) -> dict[str, Any]:
        """Return the fields by name."""
        return asdict(self)


def faulty_cells(results: Mapping[str, Mapping[str, Any]]) -> list[FaultyCell]:
    """Return the cells "drive/fault/engine" of `results`; those of truths are left out."""
    named = {tuple(name.split("/")): result for name, result in results.items() if not name.startswith("truth/")}
    return [
        FaultyCell(
            drive=drive,
            fault=fault,
            engine=engine,
            error=_error(result),
            plain=_error(named.get((drive, "none", engine), {})),
            result=result,
        )
        for (drive, fault, engine), result in named.items()
    ]


def verdicts(rows: Sequence[FaultyCell]) -> list[FaultVerdict]:
    """Return the verdicts for which there are cells."""
    return [verdict for verdict in _all_verdicts(rows) if verdict.found]


def _all_verdicts(rows: Sequence[FaultyCell]) -> Iterator[FaultVerdict]:
    by_name = {(row.name, row.engine): row for row in rows}
    graph = [row for row in rows if row.engine == GRAPH]
    against = [(row, by_name[row.name, RIVAL]) for row in graph if (row.name, RIVAL) in by_name]
    yield _compared(
        f"no cell of graph SLAM is worse than {WORSE_THAN_RIVAL:g} x GMapping's and {SMALL} m",
        [(row, max(WORSE_THAN_RIVAL * rival.error, SMALL), rival.error) for row, rival in against],
    )
    faulty = [row for row in graph if row.fault != "none"]
    yield _compared(
        f"{WITHIN:.0%} of the cells of graph SLAM are within {WORSE_THAN_UNDISTURBED:g} x undisturbed or {SMALL} m",
        [(row, max(WORSE_THAN_UNDISTURBED * row.plain, SMALL), row.plain) for row in faulty],
        least=WITHIN,
    )
    against = [(row, by_name[row.name, WITHOUT]) for row in graph if (row.name, WITHOUT) in by_name]
    yield _compared(
        "recovery is never worse than none",
        [(row, other.error + max(NOISE, NOISE_SHARE * other.error), other.error) for row, other in against],
    )
    for engine in dict.fromkeys(row.engine for row in rows):
        yield from _honest(engine, [row for row in rows if row.engine == engine and not row.failed])


def _compared(asks: str, rows: Sequence[tuple[FaultyCell, float, float]], least: float = 1.0) -> FaultVerdict:
    """Return a verdict on cells, each with the most that its error may be and what it is compared with [m]."""
    over = sorted((row for row in rows if not row[0].error <= row[1]), key=lambda row: -row[0].error / row[1])
    within = 1.0 - len(over) / max(len(rows), 1)
    missed = [f"{row.name}: {_metres(row)} > {most:.3f} m (beside {other:.3f})" for row, most, other in over]
    found = f"{len(rows) - len(over)} of {len(rows)} cells ({within:.1%})" if rows else ""
    return FaultVerdict(asks=asks, holds=within >= least, found=found, missed=missed)


def _honest(engine: str, rows: Sequence[FaultyCell]) -> Iterator[FaultVerdict]:
    off = [row for row in rows if row.result["stretches"]]
    silent = [row for row in off if row.result["told"] < row.result["stretches"]]
    share = 1.0 - len(silent) / max(len(off), 1)
    yield FaultVerdict(
        asks=f"{engine}: where it is {OFF:g} m off for {STRETCH} scans, it tells so in {TOLD:.0%} of the cells",
        holds=share >= TOLD,
        found=f"{len(off) - len(silent)} of {len(off)} cells" if rows else "",
        missed=[
            f"{row.name}: {row.result['told']} of {row.result['stretches']} stretches told, {_metres(row)}"
            for row in sorted(silent, key=lambda row: -row.error)
        ],
    )
    plain = [row for row in rows if row.fault == "none"]
    scans = sum(row.result["scans"] for row in plain)
    wrong = sum(row.result["wrongly_told"] * row.result["scans"] for row in plain) / max(scans, 1)
    yield FaultVerdict(
        asks=f"{engine}: not located though right in {WRONGLY_TOLD:.0%} of the undisturbed scans at most",
        holds=wrong <= WRONGLY_TOLD,
        found=f"{wrong:.2%} of {scans} scans" if plain else "",
        missed=_wrong_shares(plain),
    )


def _wrong_shares(rows: Iterable[FaultyCell]) -> list[str]:
    shares = sorted(((row.result["wrongly_told"], row.drive) for row in rows), reverse=True)
    return [f"{drive}: {share:.1%}" for share, drive in shares if share > WRONGLY_TOLD]


def _metres(row: FaultyCell) -> str:
    return f"{row.error:.3f} m" if row.failed is None else row.failed


def _error(result: Mapping[str, Any]) -> float:
    """Return the error of a result [m]: inf of an engine that failed, NaN where there is no result."""
    if "failed" in result:
        return math.inf
    return float(result["error"]["m"]) if result else math.nan
