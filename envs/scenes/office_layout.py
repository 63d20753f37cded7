"""How rooms lie along corridors: the kinds of office floors, drawn from a seed.

All lengths are whole multiples of a cell of 5 cm, on which the floor is painted.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from .cells import FreeSpace

CELL = 0.05
"""Side of a cell [m]."""
WALL = 0.15
"""Thickness of the walls between two rooms [m]."""
_MARGIN = 0.5


@dataclass(frozen=True)
class Rectangle:
    """A part of the floor.

    Attributes:
        x0: Left edge [m].
        y0: Lower edge [m].
        x1: Right edge [m].
        y1: Upper edge [m].
    """

    x0: float
    y0: float
    x1: float
    y1: float

    @property
    def middle(self) -> tuple[float, float]:
        """Centre (x, y) [m]."""
        return (self.x0 + self.x1) / 2.0, (self.y0 + self.y1) / 2.0

    def transposed(self) -> "Rectangle":
        """Return it with x and y exchanged."""
        return Rectangle(self.y0, self.x0, self.y1, self.x1)


@dataclass(frozen=True)
class OfficeLayout:
    """A floor of an office.

    Attributes:
        corridors: Where nobody sits.
        rooms: Rooms and halls.
        doors: Openings in the walls between them, as deep as the wall.
    """

    corridors: tuple[Rectangle, ...]
    rooms: tuple[Rectangle, ...]
    doors: tuple[Rectangle, ...]

    def painted(self) -> FreeSpace:
        """Return the floor without furniture as cells, with a margin for the outer walls."""
        parts = (*self.corridors, *self.rooms, *self.doors)
        low = np.array([min(p.x0 for p in parts), min(p.y0 for p in parts)]) - _MARGIN
        high = np.array([max(p.x1 for p in parts), max(p.y1 for p in parts)]) + _MARGIN
        cols, rows = np.rint((high - low) / CELL).astype(int)
        free: NDArray[np.bool_] = np.zeros((rows, cols), dtype=bool)
        for part in parts:
            c0, r0, c1, r1 = np.rint((np.array([part.x0, part.y0, part.x1, part.y1]) - [*low, *low]) / CELL).astype(int)
            free[r0:r1, c0:c1] = True
        return FreeSpace(free, CELL, (float(low[0]), float(low[1])))


def spine(rng: np.random.Generator) -> OfficeLayout:
    """Return one long corridor with rooms on both sides."""
    length, width = _drawn(rng, 18.0, 27.0), _drawn(rng, 2.0, 2.8)
    above = _row(rng, 0.0, length, width, up=True)
    below = _row(rng, 0.0, length, 0.0, up=False)
    return _joined((Rectangle(0.0, 0.0, length, width),), above, below)


def hall(rng: np.random.Generator) -> OfficeLayout:
    """Return a corridor with rooms on one side and an open-plan office on the other."""
    length, width = _drawn(rng, 16.0, 23.0), _drawn(rng, 2.0, 2.6)
    depth = _drawn(rng, 5.5, 7.5)
    floor = Rectangle(0.0, -WALL - depth, length, -WALL)
    entries = [_drawn(rng, 1.0, 2.5), length - _drawn(rng, 3.0, 4.5)]
    if rng.random() < 0.5:
        entries.append(round(length / 2.0, 1))
    doors = [Rectangle(x, -WALL, x + _drawn(rng, 1.4, 1.9), 0.0) for x in entries]
    above = _row(rng, 0.0, length, width, up=True)
    return _joined((Rectangle(0.0, 0.0, length, width),), above, ([floor], doors))


def ring(rng: np.random.Generator) -> OfficeLayout:
    """Return a corridor round a core of rooms, with more rooms on one outer side."""
    length, depth, width = _drawn(rng, 15.0, 20.0), _drawn(rng, 4.5, 6.0), _drawn(rng, 1.9, 2.5)
    x0, y0 = width + WALL, width + WALL
    x1, y1 = x0 + length, y0 + depth
    right, top = x1 + WALL + width, y1 + WALL + width
    corridors = (
        Rectangle(0.0, 0.0, right, width),
        Rectangle(0.0, top - width, right, top),
        Rectangle(0.0, 0.0, width, top),
        Rectangle(right - width, 0.0, right, top),
    )
    edges = _cuts(rng, x0, x1, 4.0)
    core = [Rectangle(a, y0, b, y1) for a, b in edges]
    doors = []
    for room in core:
        if rng.random() < 0.75:
            doors.append(_door(rng, room.x0, room.x1, y0 - WALL))
        if rng.random() < 0.75 or not doors:
            doors.append(_door(rng, room.x0, room.x1, y1))
    outer = _row(rng, 0.0, right, top, up=True)
    return _joined(corridors, (core, doors), outer)


def elbow(rng: np.random.Generator) -> OfficeLayout:
    """Return two corridors at a right angle with rooms on the outer sides of both."""
    first, second, width = _drawn(rng, 13.0, 18.0), _drawn(rng, 11.0, 15.0), _drawn(rng, 2.0, 2.8)
    corridors = (Rectangle(0.0, 0.0, first, width), Rectangle(first - width, 0.0, first, second))
    below = _row(rng, 0.0, first, 0.0, up=False)
    rooms, doors = _row(rng, 0.0, second, first, up=True)
    beside = ([room.transposed() for room in rooms], [door.transposed() for door in doors])
    inside = _row(rng, 0.0, first - width - WALL, width, up=True)
    return _joined(corridors, below, beside, inside)


TRAINING = (spine, hall)
"""Kinds of floors for training."""
TESTING = (ring, elbow)
"""Kinds of floors for testing, none of them seen in training."""

Row = tuple[list[Rectangle], list[Rectangle]]


def _joined(corridors: tuple[Rectangle, ...], *rows: Row) -> OfficeLayout:
    rooms = tuple(room for row in rows for room in row[0])
    return OfficeLayout(corridors, rooms, tuple(door for row in rows for door in row[1]))


def _row(rng: np.random.Generator, x0: float, x1: float, edge: float, *, up: bool) -> Row:
    """Return rooms and doors along a corridor whose side lies at y = `edge`, above it (`up`) or below."""
    depth = _drawn(rng, 4.0, 5.5)
    low = edge + WALL if up else edge - WALL - depth
    rooms = [Rectangle(a, low, b, low + depth) for a, b in _cuts(rng, x0, x1, 3.6)]
    doors = [_door(rng, room.x0, room.x1, edge if up else edge - WALL) for room in rooms]
    for left, right in pairwise(rooms):
        if rng.random() < 0.6:
            at = _drawn(rng, low + 0.8, low + depth - 2.2)
            doors.append(Rectangle(left.x1, at, right.x0, at + _drawn(rng, 1.2, 1.4)))
    return rooms, doors


def _cuts(rng: np.random.Generator, x0: float, x1: float, least: float) -> list[tuple[float, float]]:
    """Return (from, to) of rooms side by side between `x0` and `x1`, with walls between them."""
    edges, at = [], x0
    while x1 - at >= 2.0 * least + WALL:
        width = _drawn(rng, least, min(6.5, x1 - at - least - WALL))
        edges.append((at, at + width))
        at += width + WALL
    return [*edges, (at, x1)]


def _door(rng: np.random.Generator, x0: float, x1: float, wall: float) -> Rectangle:
    width = _drawn(rng, 1.2, 1.5)
    at = _drawn(rng, x0 + 0.4, x1 - 0.4 - width)
    return Rectangle(at, wall, at + width, wall + WALL)


def _drawn(rng: np.random.Generator, low: float, high: float) -> float:
    """Return a length between two others, a whole number of cells [m]."""
    return round(float(rng.uniform(low, max(low, high))) / CELL) * CELL
