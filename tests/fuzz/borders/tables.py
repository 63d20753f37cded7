"""Trajectories, relations, pose graphs, walks of pedestrians: texts of numbers."""

from pathlib import Path
from typing import Any

import numpy as np
from borders.logs import hostile
from fuzzer import grammars
from fuzzer.border import Border, Input, require
from fuzzer.files import put
from fuzzer.sanity import finite, sane_poses, sane_times
from tagalong.slam.logs import read_tum
from tagalong.slam.logs.g2o import read_g2o
from tagalong.slam.logs.pedestrians import read_pedestrians
from tagalong.slam.logs.relations import read_readings, read_relations

NAME = "table.txt"


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


BORDERS = (
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
)  # fmt: skip
