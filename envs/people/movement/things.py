"""Walls and furniture on a grid: who stands somewhere needs to look at what is near only."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....slam.view_kernel import kernel, view_kernel
from .obstacles import nearest_of_box

Array = NDArray[np.float64]
Ints = NDArray[np.int32]

CELL = 0.5
"""Side of a cell of the grid [m], where the building is no larger than `_MOST` cells."""
_MOST = 400  # cells along a side


class Things(NamedTuple):
    """Walls and furniture, and in which cells of a grid they matter; kernels take it as it is.

    Attributes:
        boxes: (b, 6) see `obstacles.nearest_of_box`.
        circles: (c, 3) x, y, radius [m].
        frame: (5,) x, y of the grid's corner, side of its cells [m], columns, rows.
        first: (cells + 1,) where the items of each cell begin.
        items: (k,) what matters to people in a cell: k is the box k, -1 - k the circle k; boxes first, both ascending.
    """

    boxes: Array
    circles: Array
    frame: Array
    first: Ints
    items: Ints


def things_around(boxes: Array, circles: Array, reach: float) -> Things:
    """Return walls and furniture with the cells in which each is nearer than `reach` [m] to some point."""
    low, high = np.zeros(2), np.zeros(2)
    if len(boxes) + len(circles):
        extent = np.concatenate((np.hypot(boxes[:, 4], boxes[:, 5]), circles[:, 2]))
        middles = np.concatenate((boxes[:, :2], circles[:, :2]))
        low = (middles - extent[:, None]).min(axis=0) - reach
        high = (middles + extent[:, None]).max(axis=0) + reach
    side = max(CELL, float((high - low).max()) / _MOST)
    cols, rows = (np.floor((high - low) / side).astype(int) + 1).tolist()
    frame = np.array((*low.tolist(), side, cols, rows))
    first, items = _sorted_in(frame, boxes, circles, reach + 0.7072 * side)
    return Things(boxes, circles, frame, first, items)


@view_kernel
def cell_of(x: float, y: float, frame: Array) -> int:
    """Return the number of the cell at a point; the nearest one for points outside, near which nothing stands."""
    col = min(max((x - frame[0]) / frame[2], 0.0), frame[3] - 1.0)
    row = min(max((y - frame[1]) / frame[2], 0.0), frame[4] - 1.0)
    return int(row) * int(frame[3]) + int(col)


@kernel
def _sorted_in(frame: Array, boxes: Array, circles: Array, reach: float) -> tuple[Ints, Ints]:
    """Return `Things.first` and `Things.items`: what is nearer than `reach` to the middle of a cell belongs to it."""
    cols, rows = int(frame[3]), int(frame[4])
    first = np.zeros(cols * rows + 1, dtype=np.int32)
    items = np.zeros(0, dtype=np.int32)
    for filling in (False, True):  # counts at first, then fills
        at = np.zeros(cols * rows, dtype=np.int32)
        if filling:
            for cell in range(cols * rows):
                first[cell + 1] += first[cell]
            at[:] = first[:-1]
            items = np.zeros(first[-1], dtype=np.int32)
        for k in range(len(boxes) + len(circles)):
            round_ = k >= len(boxes)
            if round_:
                x, y, extent = circles[k - len(boxes), 0], circles[k - len(boxes), 1], circles[k - len(boxes), 2]
            else:
                x, y, extent = boxes[k, 0], boxes[k, 1], math.hypot(boxes[k, 4], boxes[k, 5])
            extent += reach
            col0, col1 = int((x - extent - frame[0]) / frame[2]), int((x + extent - frame[0]) / frame[2])
            row0, row1 = int((y - extent - frame[1]) / frame[2]), int((y + extent - frame[1]) / frame[2])
            for row in range(max(row0, 0), min(row1, rows - 1) + 1):
                for col in range(max(col0, 0), min(col1, cols - 1) + 1):
                    px, py = frame[0] + (col + 0.5) * frame[2], frame[1] + (row + 0.5) * frame[2]
                    if round_:
                        away = math.hypot(px - x, py - y) - (extent - reach)
                    else:
                        away = nearest_of_box(px, py, boxes[k])[0]
                    if away < reach:
                        cell = row * cols + col
                        if filling:
                            items[at[cell]] = len(boxes) - 1 - k if round_ else k
                            at[cell] += 1
                        else:
                            first[cell + 1] += 1
    return first, items


@view_kernel
def keep_clear(x: float, y: float, room: float, things: Things) -> tuple[float, float]:
    """Return the point (x, y) moved out of whatever is nearer than `room` [m]."""
    cell = cell_of(x, y, things.frame)
    for k in range(things.first[cell], things.first[cell + 1]):
        item = things.items[k]
        if item >= 0:
            box = things.boxes[item]
            dx, dy = x - box[0], y - box[1]
            if abs(box[2] * dx + box[3] * dy) >= box[4] + room or abs(box[2] * dy - box[3] * dx) >= box[5] + room:
                continue
            distance, ux, uy = nearest_of_box(x, y, box)
            push = max(room - distance, 0.0)
            x, y = x + push * ux, y + push * uy
        else:
            circle = things.circles[-1 - item]
            dx, dy, apart = x - circle[0], y - circle[1], circle[2] + room
            if dx * dx + dy * dy < apart * apart:
                away = max(math.sqrt(dx * dx + dy * dy), 1e-6)
                x, y = x + (apart - away) * dx / away, y + (apart - away) * dy / away
    return x, y
