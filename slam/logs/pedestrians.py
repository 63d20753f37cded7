"""Recorded walks of pedestrians, in the two usual text forms of the ETH and UCY recordings.

ETH: Pellegrini et al. 2009; UCY: Lerner et al. 2007. A line is `frame id x y`, or `frame id x z y vx vz vy` (the
`obsmat` form), in metres. Frames are counted in video frames; one step between two annotated ones lasts 0.4 s.
"""

import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError, shown
from .text import MOST_POSES, numbered_lines

Array = NDArray[np.float64]

STEP_S = 0.4
"""Time between two annotated frames [s]."""
_FEWEST = 6
_MOST_COLUMNS = 8
_LARGEST = 1e9  # of a number: a year of video frames; no place is that far
_FARTHEST_STEP_M = 100.0


@dataclass(frozen=True, eq=False)
class RecordedWalk:
    """One person's way.

    Attributes:
        person: The recording's number of the person.
        time_s: (k,) [s], ascending.
        points: (k, 2) [m], as annotated: with noise of centimetres.
    """

    person: int
    time_s: Array
    points: Array

    def smoothed(self) -> "RecordedWalk":
        """Return it with every inner point moved to the weighted mean of itself and its neighbours, twice."""
        points = self.points.copy()
        for _ in range(2):
            points[1:-1] = 0.25 * points[:-2] + 0.5 * points[1:-1] + 0.25 * points[2:]
        return RecordedWalk(self.person, self.time_s, points)


def read_pedestrians(path: str | os.PathLike[str]) -> list[RecordedWalk]:
    """Return the walks of at least 6 points in a file, plain or gzip.

    Raises:
        InputError: If the file cannot be read, a line has neither 4 nor 8 numbers, nobody walks in it, or somebody
            goes 100 m from one row to the next.
    """
    file = Path(path)
    rows = [
        _numbers(file, number, line) for number, line in numbered_lines(file, most_lines=MOST_POSES) if line.strip()
    ]
    if len({len(row) for row in rows}) > 1:
        raise InputError(f"{file}: some lines have 4 numbers and some 8")
    y = 4 if rows and len(rows[0]) == 8 else 3
    walks = _walks(np.array([(row[0], row[1], row[2], row[y]) for row in rows])) if rows else []
    if not walks:
        raise InputError(f"{file}: nobody walks for {_FEWEST} steps or more in it")
    for walk in walks:
        farthest = float(np.abs(np.diff(walk.points, axis=0)).max())
        if farthest > _FARTHEST_STEP_M:
            raise InputError(
                f"{file}: person {walk.person} goes {farthest:.3g} m from one row to the next: nobody walks that far"
            )
    return walks


def _walks(table: Array) -> list[RecordedWalk]:
    """Return the walks in a table of frame, id, x, y; a step is the commonest distance of a person's frames."""
    walks = []
    table = table[np.argsort(table[:, 1], kind="stable")]
    rows = np.split(table, np.flatnonzero(np.diff(table[:, 1])) + 1)
    rows = [part[np.argsort(part[:, 0], kind="stable")] for part in rows]
    gaps = np.concatenate([np.diff(part[:, 0]) for part in rows])
    gaps = gaps[gaps > 0.0]
    if len(gaps) == 0:
        return []
    values, counts = np.unique(gaps, return_counts=True)
    step = values[counts.argmax()]
    for part in rows:
        fresh = np.concatenate(([True], np.diff(part[:, 0]) > 0.0))
        part = part[fresh]
        if len(part) >= _FEWEST:
            walks.append(RecordedWalk(int(part[0, 1]), part[:, 0] / step * STEP_S, part[:, 2:4].copy()))
    return walks


def _numbers(file: Path, number: int, line: str) -> list[float]:
    try:
        values = [float(word) for word in line.split(maxsplit=_MOST_COLUMNS)]
    except ValueError:
        values = []
    if len(values) not in (4, 8) or not all(abs(value) <= _LARGEST for value in values):
        raise InputError(f"{file}, line {number}: needs `frame id x y` or `frame id x z y vx vz vy`, got {shown(line)}")
    return values
