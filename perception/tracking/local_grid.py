"""Where non-human things stand around the robot, in the odometry frame (Ye 2021, section II.A).

A cell is *free* unless non-human points have stayed on it: evidence rises while they do and fades when they go. Only
the cells hit are touched; they live in a ring buffer of `SIDE` x `SIDE` cells around the robot, each with the cell
number it stands for, so the robot may drive on for ever.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...slam.view_kernel import kernel

Array = NDArray[np.float64]

SIDE = 512
"""Cells along a side of the ring buffer, a power of two."""
OCCUPIED = 0.5
CELL = np.dtype([("x", np.uint16), ("y", np.uint16), ("evidence", np.float32), ("time_s", np.float64)])
"""A cell in sixteen bytes, so that a visit waits for memory once: which of the blocks of `SIDE` cells it lies in (they
come again after 65,536 blocks, when the evidence is long gone), its evidence, 0 for none, and when it was last hit."""
_BITS, _INSIDE, _BLOCKS = 9, SIDE - 1, 65535


class LocalGrid:
    """Evidence of non-human things a cell.

    Args:
        resolution: Side of a cell [m]; the grid covers `SIDE / 2` cells around the robot.
        rise_s: Time under points until a cell's evidence is full [s].
        fade_s: Time constant with which evidence fades [s].
    """

    def __init__(self, resolution: float, rise_s: float, fade_s: float) -> None:
        self._resolution, self._rise_s, self._fade_s = resolution, rise_s, fade_s
        self._cells = np.zeros(SIDE * SIDE, dtype=CELL)

    def mark(self, points: Array, centre: Array, time_s: float, dt: float) -> None:
        """Add `dt` seconds of non-human `points` (k, 2) seen at `time_s` from `centre` (2,), in the odometry frame."""
        mark(self._cells, points, centre, self._resolution, time_s, dt / self._rise_s, self._fade_s)

    def is_free(self, points: Array, time_s: float) -> NDArray[np.bool_]:
        """Return (n,) whether the cells of `points` (n, 2) and the eight around each are free at `time_s`."""
        return are_free(self._cells, points, self._resolution, time_s, self._fade_s)


@kernel
def mark(cells: Any, points: Any, centre: Any, resolution: float, now: float, rise: float, fade_s: float) -> None:
    """Let the evidence of the `cells` under `points` (k, 2) `rise`, see `LocalGrid.mark`."""
    reach = (SIDE // 2 - 2) * resolution
    last, fading = now, 1.0  # most cells were hit in the same scan before
    for k in range(len(points)):
        if not max(abs(points[k, 0] - centre[0]), abs(points[k, 1] - centre[1])) < reach:
            continue
        x, y = int(np.floor(points[k, 0] / resolution)), int(np.floor(points[k, 1] / resolution))
        cell = cells[(x & _INSIDE) * SIDE + (y & _INSIDE)]
        block_x, block_y = np.uint16((x >> _BITS) & _BLOCKS), np.uint16((y >> _BITS) & _BLOCKS)
        if cell.x != block_x or cell.y != block_y:
            cell.x, cell.y = block_x, block_y
            cell.evidence = 0.0
        elif cell.evidence > 0.0:
            if cell.time_s == now:
                continue
            if cell.time_s != last:
                last = cell.time_s
                fading = np.exp((last - now) / fade_s)
        cell.evidence = min(1.0, cell.evidence * fading + rise) if cell.evidence > 0.0 else min(1.0, rise)
        cell.time_s = now


@kernel
def are_free(cells: Any, points: Any, resolution: float, now: float, fade_s: float) -> Any:
    """Return (n,) whether the cells of `points` (n, 2) and the eight around each are free, see `LocalGrid.is_free`."""
    free = np.ones(len(points), np.bool_)
    for k in range(len(points)):
        i, j = int(np.floor(points[k, 0] / resolution)), int(np.floor(points[k, 1] / resolution))
        for x in range(i - 1, i + 2):
            for y in range(j - 1, j + 2):
                cell = cells[(x & _INSIDE) * SIDE + (y & _INSIDE)]
                here = cell.x == (x >> _BITS) & _BLOCKS and cell.y == (y >> _BITS) & _BLOCKS
                if here and cell.evidence * np.exp((cell.time_s - now) / fade_s) >= OCCUPIED:
                    free[k] = False
    return free
