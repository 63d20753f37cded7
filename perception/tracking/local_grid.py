"""Where non-human things stand around the robot, in the odometry frame (Ye 2021, section II.A).

A cell is *free* unless non-human points have stayed on it: evidence rises while they do and fades when they go. Only
the cells hit are touched; they live in a ring buffer of `SIDE` x `SIDE` cells around the robot, each with the cell
number it stands for, so the robot may drive on for ever.
"""

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]

SIDE = 512
OCCUPIED = 0.5


class LocalGrid:
    """Evidence of non-human things a cell.

    Args:
        resolution: Side of a cell [m]; the grid covers `SIDE / 2` cells around the robot.
        rise_s: Time under points until a cell's evidence is full [s].
        fade_s: Time constant with which evidence fades [s].
    """

    def __init__(self, resolution: float, rise_s: float, fade_s: float) -> None:
        self._resolution, self._rise_s, self._fade_s = resolution, rise_s, fade_s
        self._cell = np.full((SIDE * SIDE, 2), np.iinfo(np.int32).min, dtype=np.int32)
        self._evidence = np.zeros(SIDE * SIDE, dtype=np.float32)
        self._time = np.full(SIDE * SIDE, -np.inf)

    def mark(self, points: Array, centre: Array, time_s: float, dt: float) -> None:
        """Add `dt` seconds of non-human `points` (k, 2) seen at `time_s` from `centre` (2,), in the odometry frame."""
        reach = (SIDE // 2 - 2) * self._resolution
        place = points, centre, reach, self._resolution
        _mark(self._cell, self._evidence, self._time, *place, time_s, dt / self._rise_s, self._fade_s)

    def is_free(self, points: Array, time_s: float) -> NDArray[np.bool_]:
        """Return (n,) whether the cells of `points` (n, 2) and the eight around each are free at `time_s`."""
        evidence = np.zeros(len(points))
        _strongest(self._cell, self._evidence, self._time, points, self._resolution, time_s, self._fade_s, evidence)
        return evidence < OCCUPIED


@njit(cache=True, nogil=True)
def _mark(
    cell: Any,
    evidence: Any,
    time: Any,
    points: Any,
    centre: Any,
    reach: float,
    resolution: float,
    now: float,
    rise: float,
    fade_s: float,
) -> None:
    for k in range(len(points)):
        if not max(abs(points[k, 0] - centre[0]), abs(points[k, 1] - centre[1])) < reach:
            continue
        x, y = int(np.floor(points[k, 0] / resolution)), int(np.floor(points[k, 1] / resolution))
        slot = (x % SIDE) * SIDE + y % SIDE
        if cell[slot, 0] != x or cell[slot, 1] != y:
            cell[slot, 0], cell[slot, 1] = x, y
            evidence[slot] = 0.0
        elif time[slot] == now:
            continue
        faded = evidence[slot] * np.exp((time[slot] - now) / fade_s) if evidence[slot] > 0.0 else 0.0
        evidence[slot] = min(1.0, faded + rise)
        time[slot] = now


@njit(cache=True, nogil=True)
def _strongest(
    cell: Any, evidence: Any, time: Any, points: Any, resolution: float, now: float, fade_s: float, out: Any
) -> None:
    for k in range(len(points)):
        i, j = int(np.floor(points[k, 0] / resolution)), int(np.floor(points[k, 1] / resolution))
        for x in range(i - 1, i + 2):
            for y in range(j - 1, j + 2):
                slot = (x % SIDE) * SIDE + y % SIDE
                if cell[slot, 0] == x and cell[slot, 1] == y:
                    out[k] = max(out[k], evidence[slot] * np.exp((time[slot] - now) / fade_s))
