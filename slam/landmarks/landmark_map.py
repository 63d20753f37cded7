"""A map of landmarks and its files: what EKF-SLAM writes, and localization on known landmarks reads.

JSON (`.json`), lengths in metres; `covariance` (xx, xy, yy) and `seen` may be left out:

    {"landmarks": [{"x": 2.31, "y": -0.84, "covariance": [1e-4, 0.0, 2e-4], "seen": 17}, ...]}

CSV (`.csv`), the first line names the columns, `x,y` or `x,y,xx,xy,yy`:

    x,y,xx,xy,yy
    2.31,-0.84,1e-4,0.0,2e-4
"""

import math
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from ..bounds import FREE_CELLS, check_points, check_size
from ..errors import InputError, shown
from ..files.input import named, names_file, read_json
from ..files.output import write_json
from ..logs.text import finite_numbers, numbered_lines, write_lines
from ..occupancy_map import OccupancyMap

Array = NDArray[np.float64]

MOST_LANDMARKS = 10_000
"""Landmarks of a map: each sighting is compared with all of them."""
_MOST_SIGMA_M = 100.0  # nobody knows of a landmark that may be anywhere within 100 m
_COLUMNS = (("x", "y"), ("x", "y", "xx", "xy", "yy"))


@dataclass(frozen=True, eq=False)
class LandmarkMap:
    """Landmarks at known places.

    Attributes:
        places: (k, 2) where they are, map frame [m].
        covariances: (k, 2, 2) of that [m^2]; zero where they are known exactly.
        times_seen: (k,) how often each was seen; 0: nobody says.

    Raises:
        InputError: If there is none, or too many, shapes do not agree, or a number is beyond what it can be.
    """

    places: Array
    covariances: Array
    times_seen: NDArray[np.int64]

    def __post_init__(self) -> None:
        k = len(self.places)
        if not 1 <= k <= MOST_LANDMARKS:
            raise InputError(f"a map of landmarks has 1 .. {MOST_LANDMARKS} landmarks, got {k}")
        if self.places.shape != (k, 2) or self.covariances.shape != (k, 2, 2) or self.times_seen.shape != (k,):
            shapes = f"{self.places.shape}, {self.covariances.shape}, {self.times_seen.shape}"
            raise InputError(f"`places` (k, 2), `covariances` (k, 2, 2) and `times_seen` (k,) needed, got {shapes}")
        check_points(self.places, "places")
        xx, xy, yy = self.covariances[:, 0, 0], self.covariances[:, 0, 1], self.covariances[:, 1, 1]
        good = (xx >= 0.0) & (yy >= 0.0) & (xy**2 <= xx * yy * (1.0 + 1e-6)) & (xx + yy <= _MOST_SIGMA_M**2)
        if not (good & (xy == self.covariances[:, 1, 0])).all():
            k = int(np.argmin(good))
            raise InputError(
                f"the covariance of landmark {k} must be one (xx, yy >= 0, xy^2 <= xx yy, below {_MOST_SIGMA_M:g} m), "
                f"got {shown(self.covariances[k].tolist())}"
            )

    def __len__(self) -> int:
        return len(self.places)

    def drawn(self, radius: float = 0.1, resolution: float = 0.05) -> OccupancyMap:
        """Return a picture of the map: free, but for the discs of `radius` [m] that the landmarks are.

        Raises:
            InputError: If the landmarks lie so far apart that no picture shows them.
        """
        low, high = self.places.min(axis=0) - 1.0, self.places.max(axis=0) + 1.0
        columns, rows = np.ceil((high - low) / resolution).astype(np.int64).tolist()
        check_size(columns, rows, resolution, FREE_CELLS)
        cells, reach = np.zeros((rows, columns), dtype=np.float32), math.ceil(radius / resolution)
        for place in (self.places - low) / resolution:
            column, row = np.floor(place).astype(np.int64).tolist()
            around = np.s_[row - reach : row + reach + 1, column - reach : column + reach + 1]
            y, x = np.mgrid[around]
            cells[around][np.hypot(x + 0.5 - place[0], y + 0.5 - place[1]) * resolution <= radius] = 1.0
            cells[row, column] = 1.0
        return OccupancyMap(cells, resolution, (float(low[0]), float(low[1])))


@runtime_checkable
class LandmarkMapper(Protocol):
    """An engine whose map is made of landmarks."""

    def landmark_map(self) -> LandmarkMap | None:
        """Return the landmarks that it is sure of; None: there is none yet."""
        ...


def write_landmark_map(path: str | os.PathLike[str], landmarks: LandmarkMap) -> None:
    """Write a map of landmarks as JSON or CSV, by the end of its name.

    Raises:
        InputError: If the name ends otherwise, or nothing can be written there.
    """
    entries = [landmarks.covariances[:, 0, 0], landmarks.covariances[:, 0, 1], landmarks.covariances[:, 1, 1]]
    rows = np.column_stack((landmarks.places, *entries)).tolist()
    if _suffix(path) == ".csv":
        write_lines(path, (",".join(_COLUMNS[1]), *(",".join(map(repr, row)) for row in rows)))
        return
    seen = landmarks.times_seen.tolist()
    made = [{"x": r[0], "y": r[1], "covariance": r[2:], "seen": n} for r, n in zip(rows, seen, strict=True)]
    write_json(path, {"landmarks": made})


@names_file
def read_landmark_map(path: str | os.PathLike[str]) -> LandmarkMap:
    """Read a map of landmarks (JSON or CSV, see above).

    Raises:
        InputError: In one line, with the file and the landmark or line, where it is not what the format says.
    """
    rows = _rows_of_csv(path) if _suffix(path) == ".csv" else _rows_of_json(path)
    table = np.array(rows, dtype=np.float64).reshape(-1, 6)
    xx, xy, yy = table[:, 2:5].T
    covariances = np.stack((np.stack((xx, xy), -1), np.stack((xy, yy), -1)), -2)
    return LandmarkMap(table[:, :2].copy(), covariances, table[:, 5].astype(np.int64))


def _suffix(path: str | os.PathLike[str]) -> str:
    suffix = Path(os.fsdecode(path)).suffix
    if suffix not in (".json", ".csv"):
        raise InputError(f"{named(path)}: a map of landmarks is a .json or .csv file")
    return suffix


def _rows_of_csv(path: str | os.PathLike[str]) -> list[tuple[float, ...]]:
    """Return (x, y, xx, xy, yy, 0) of each line."""
    columns: tuple[str, ...] = ()
    rows = []
    for number, line in numbered_lines(path, most_lines=MOST_LANDMARKS + 100):
        words = [word.strip() for word in line.split(",")]
        if not line.strip():
            continue
        where = f"{named(path)}:{number}"
        if not columns:
            columns = tuple(words)
            if columns not in _COLUMNS:
                raise InputError(f"{where}: the first line must be `x,y` or `x,y,xx,xy,yy`, got {shown(line)}")
            continue
        if len(words) != len(columns):
            raise InputError(f"{where}: {len(columns)} numbers needed ({','.join(columns)}), got {shown(line)}")
        values = finite_numbers(words, where)
        rows.append((*values, *[0.0] * (6 - len(values))))
    return rows


def _rows_of_json(path: str | os.PathLike[str]) -> list[tuple[float, ...]]:
    """Return (x, y, xx, xy, yy, seen) of each landmark."""
    content = read_json(path)
    entries = content.get("landmarks") if isinstance(content, dict) else None
    if not isinstance(entries, list):
        raise InputError(f'must be {{"landmarks": [{{"x": .., "y": ..}}, ..]}}, got {shown(content)}')
    return [_row(entry, f"landmark {k}") for k, entry in enumerate(entries)]


def _row(entry: Any, where: str) -> tuple[float, ...]:
    if not isinstance(entry, dict) or not {"x", "y"} <= set(entry) <= {"x", "y", "covariance", "seen"}:
        raise InputError(f"{where} must have `x`, `y`, and may have `covariance`, `seen`, got {shown(entry)}")
    covariance, seen = entry.get("covariance", [0.0, 0.0, 0.0]), entry.get("seen", 0)
    if not isinstance(covariance, list) or len(covariance) != 3:
        raise InputError(f"{where}: `covariance` must be three numbers (xx, xy, yy), got {shown(covariance)}")
    if not isinstance(seen, int) or isinstance(seen, bool) or not 0 <= seen <= 1_000_000_000:
        raise InputError(f"{where}: `seen` must be a whole number, not negative, got {shown(seen)}")
    values = (entry["x"], entry["y"], *covariance)
    for value in values:
        if not isinstance(value, (int, float)) or isinstance(value, bool) or not abs(value) <= 1e18:
            raise InputError(f"{where}: finite numbers needed, got {shown(value)}")
    return (*map(float, values), float(seen))
