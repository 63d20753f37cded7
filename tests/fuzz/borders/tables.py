"""Trajectories, relations, pose graphs, walks of pedestrians: texts of numbers."""

from pathlib import Path
from typing import Any

import numpy as np
from borders.logs import hostile
from fuzzer import grammars
from fuzzer.border import Area, Border, Input, require
from fuzzer.files import put
from fuzzer.sanity import finite, sane_poses, sane_times
from numpy.random import Generator
from tagalong.scripts.runs.scoring import ScoringOptions, judge
from tagalong.slam.logs.g2o import read_g2o
from tagalong.slam.logs.pedestrians import read_pedestrians
from tagalong.slam.logs.relations import read_readings, read_relations
from tagalong.slam.logs.tum import read_tum

NAME = "table.txt"
_GRAMMARS = {
    "tum": grammars.tum,
    "relations": grammars.relations,
    "log": grammars.carmen,
    "readings": grammars.readings,
}


def _tum(value: Input, folder: Path) -> Any:
    return read_tum(put(folder, NAME, value))


def _sane_trajectory(result: Any) -> None:
    sane_times(result.times_s)
    sane_poses(result.poses)


def _sane_relations(result: Any) -> None:
    sane_times(np.concatenate((result.first, result.second)))
    sane_poses(result.T_first_second)


def _sane_readings(result: Any) -> None:
    sane_times(result.times_s)
    sane_poses(result.odometry)


def _sane_graph(result: Any) -> None:
    sane_poses(result.poses)
    sane_poses(result.measurements)
    finite(result.information, "information")


def _sane_walks(result: Any) -> None:
    require(len(result) > 0, "no walks")
    for walk in result:
        sane_times(walk.time_s)
        finite(walk.points, "points", 1e7)


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


AREA = Area(
    (
        Border(name="tables.tum", make=hostile(grammars.tum), call=_tum, sane=_sane_trajectory, file=NAME, ms=0.3),
        Border(
            name="tables.relations", make=hostile(grammars.relations), file=NAME, ms=0.66, sane=_sane_relations,
            call=lambda value, folder: read_relations(put(folder, NAME, value)),
        ),
        Border(
            name="tables.readings", make=hostile(grammars.readings), file=NAME, ms=0.57, sane=_sane_readings,
            call=lambda value, folder: read_readings(put(folder, NAME, value)),
        ),
        Border(
            name="tables.g2o", make=hostile(grammars.g2o), file=NAME, ms=0.4, sane=_sane_graph,
            call=lambda value, folder: read_g2o(put(folder, NAME, value)),
        ),
        Border(
            name="tables.pedestrians", make=hostile(grammars.pedestrians), file=NAME, ms=0.32, sane=_sane_walks,
            call=lambda value, folder: read_pedestrians(put(folder, NAME, value)),
        ),
        Border(name="tables.score", make=_pair, call=_judge, sane=_sane_judgement, ms=0.54),
    )
)  # fmt: skip
