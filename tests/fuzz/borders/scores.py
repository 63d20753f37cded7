"""The scores of a trajectory: an estimate and a reference of any kinds."""

from pathlib import Path
from typing import Any

from borders.logs import hostile
from fuzzer import grammars
from fuzzer.border import Border, Input
from fuzzer.files import put
from fuzzer.sanity import finite
from numpy.random import Generator
from tagalong.scripts.runs.scoring import ScoringOptions, judge

_GRAMMARS = {
    "tum": grammars.tum,
    "relations": grammars.relations,
    "log": grammars.carmen,
    "readings": grammars.readings,
}


def _pair(rng: Generator) -> Input:
    """Return an estimate and a reference of kinds that may or may not go together, and now and then readings."""
    kinds = [list(_GRAMMARS)[int(k)] for k in rng.integers(0, 3, 2)]
    kinds[0] = "tum" if rng.random() < 0.8 else kinds[0]
    files = {name: hostile(_GRAMMARS[kind])(rng) for name, kind in zip(("est.txt", "ref.txt"), kinds, strict=True)}
    if rng.random() < 0.2:
        files["readings.txt"] = hostile(grammars.readings)(rng)
    return files


def _judge(value: Input, folder: Path) -> Any:
    files = {name: put(folder, name, content) for name, content in value.items()}
    return judge(files["est.txt"], files["ref.txt"], ScoringOptions(readings=files.get("readings.txt")))


def _sane_judgement(result: Any) -> None:
    finite(list(_numbers(result.metrics)), "scores")


def _numbers(value: Any) -> Any:
    if isinstance(value, dict):
        value = list(value.values())
    if isinstance(value, list | tuple):
        for entry in value:
            yield from _numbers(entry)
    elif isinstance(value, float):
        yield value


BORDERS = (Border(name="tables.score", make=_pair, call=_judge, sane=_sane_judgement, ms=0.54),)
