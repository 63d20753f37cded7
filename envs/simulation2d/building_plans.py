"""Floor plans drawn at random: what a laser meets in buildings of several kinds, and where a robot can drive there."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray
from scipy import ndimage

from ...slam.errors import unknown_name
from ..scenes.cells import FreeSpace
from ..scenes.ways import WayPlanner
from .outlines import Outlines

Array = NDArray[np.float64]

CLEARANCE = 0.35
"""Least distance of a robot's way from all things [m]."""
_CELL = 0.1  # of the grid of free space [m]
_THICKNESS = 0.14  # of inner walls [m]
_LEAST_AREA = 60.0  # of what can be driven [m^2]; smaller floors are drawn again ...
_LEAST_SHARE = 0.85  # ... and those of which less than this share of what is wide enough can be reached
_FIELD_CELL = 0.5  # of the field whose contour is a cave [m]


@dataclass(frozen=True, eq=False)
class BuildingPlan:
    """A floor.

    Attributes:
        outlines: What the laser meets; closed to the outside.
        inside: (2,) a place in the free space [m].
    """

    outlines: Outlines
    inside: Array

    @cached_property
    def space(self) -> FreeSpace:
        """The cells that can be reached from `inside`."""
        ellipses, segments = self.outlines.arrays()
        corners = segments[:, :4].reshape(-1, 2)
        origin = corners.min(axis=0) - 0.5
        cols, rows = np.ceil((corners.max(axis=0) + 0.5 - origin) / _CELL).astype(int)
        free = np.ones((rows, cols), dtype=np.bool_)
        for x1, y1, x2, y2 in segments[:, :4]:
            share = np.linspace(0.0, 1.0, 2 + int(np.hypot(x2 - x1, y2 - y1) / (0.4 * _CELL)))
            col, row = np.floor((np.stack((x1 + share * (x2 - x1), y1 + share * (y2 - y1))).T - origin) / _CELL).T
            free[row.astype(int), col.astype(int)] = False
        centres = (np.arange(cols) + 0.5) * _CELL + origin[0], (np.arange(rows) + 0.5) * _CELL + origin[1]
        for x, y, radius in ellipses[:, :3]:  # round ones only
            free &= np.hypot(centres[0][None] - x, centres[1][:, None] - y) > radius
        parts = np.zeros(free.shape, dtype=np.int64)
        ndimage.label(free, output=parts)
        col, row = np.floor((self.inside - origin) / _CELL).astype(int)
        return FreeSpace(free & (parts == parts[row, col]), _CELL, (float(origin[0]), float(origin[1])))

    @cached_property
    def planner(self) -> WayPlanner:
        """Plans ways through it."""
        return WayPlanner(self.space, CLEARANCE)

    @property
    def reachable(self) -> float:
        """Share of the space wide enough for a robot that lies in its largest connected part."""
        return len(self.planner.places) / max(int((self.planner.regions > 0).sum()), 1)


def draw_plan(kind: str, rng: Generator) -> BuildingPlan:
    """Draw a floor of a kind of `KINDS`.

    Raises:
        InputError: If there is no such kind.
    """
    if kind not in KINDS:
        raise unknown_name("kind of building", kind, tuple(KINDS))
    plan = KINDS[kind](rng)
    while plan.planner.area < _LEAST_AREA or plan.reachable < _LEAST_SHARE:
        plan = KINDS[kind](rng)
    return plan


def _office(rng: Generator) -> BuildingPlan:
    """A corridor with rooms on both sides, doors into it and some between them, and furniture."""
    out, length, width = Outlines(), rng.uniform(15.0, 55.0), rng.uniform(1.6, 3.0)
    linked, clutter = rng.choice([0.0, 0.5]), rng.uniform(0.0, 0.15)
    for side in (-1.0, 1.0):
        depth, wall = rng.uniform(3.5, 7.0), side * width / 2.0
        far = wall + side * depth
        edges = _cuts(rng, length, 3.0, 7.0)
        doors = [(rng.uniform(a + 0.7, b - 2.1), rng.uniform(1.1, 1.4)) for a, b in pairwise(edges)]
        _wall(out, (0.0, wall), (length, wall), doors)
        out.polygon(np.array([(0.0, wall), (0.0, far), (length, far), (length, wall)]), closed=False)
        for edge in edges[1:-1]:
            gaps = [(rng.uniform(0.8, depth - 2.0), 1.2)] if rng.random() < linked else []
            _wall(out, (edge, wall), (edge, far), gaps)
        for (a, b), (start, opening) in zip(pairwise(edges), doors, strict=True):
            low, high = np.array([a, min(wall, far)]), np.array([b, max(wall, far)])
            door = np.array([start + opening / 2.0, wall])
            for _ in range(rng.poisson(clutter * (b - a) * depth)):
                _furnish(rng, out, low, high, door)
    for end in (0.0, length):
        out.segment(np.array([end, -width / 2.0]), np.array([end, width / 2.0]))
    return BuildingPlan(out, np.array([length / 2.0, 0.0]))


def _loops(rng: Generator) -> BuildingPlan:
    """Corridors around blocks: rings that share sides; walls bare or with pilasters and recesses."""
    out, width, relief = Outlines(), rng.uniform(1.5, 3.5), rng.choice([0.0, 0.05, 0.2])
    sizes = [rng.uniform(5.0, 18.0, int(rng.integers(1, most))) for most in (4, 3)]
    starts = [width + np.concatenate(([0.0], np.cumsum(size + width)[:-1])) for size in sizes]
    high = np.array([start[-1] + size[-1] + width for start, size in zip(starts, sizes, strict=True)])
    walls = [_rectangle(np.zeros(2), high)]
    for x, dx in zip(starts[0], sizes[0], strict=True):
        for y, dy in zip(starts[1], sizes[1], strict=True):
            walls.append(_rectangle(np.array([x, y]), np.array([x + dx, y + dy])))
    for corners in walls:
        out.polygon(corners)
        for a, b in pairwise(np.concatenate((corners, corners[:1]))):
            angle = float(np.arctan2(*(b - a)[::-1]))
            for _ in range(rng.poisson(relief * np.hypot(*(b - a)))):
                out.box(a + rng.random() * (b - a), rng.uniform(0.1, 1.0), rng.uniform(0.1, 0.5), angle)
    return BuildingPlan(out, np.full(2, width / 2.0))


def _cells(rng: Generator) -> BuildingPlan:
    """A grid of equal rooms with a door in the middle of some walls, alike or each with furniture of its own."""
    out, side, opening = Outlines(), rng.uniform(3.0, 5.0), rng.uniform(1.1, 1.4)
    count = np.array([rng.integers(3, 7), rng.integers(2, 5)])
    alike, pieces = rng.random() < 0.4, rng.uniform(0.0, 1.5)
    out.polygon(_rectangle(np.zeros(2), np.asarray(count * side, dtype=np.float64)))
    rooms = [(i, j) for i in range(count[0]) for j in range(count[1])]
    group = {room: k for k, room in enumerate(rooms)}
    walls = [(room, (room[0] + di, room[1] + dj)) for room in rooms for di, dj in ((1, 0), (0, 1))]
    walls = [wall for wall in walls if wall[1] in group]
    for k in rng.permutation(len(walls)):
        (i, j), other = walls[k]
        joins = group[i, j] != group[other]
        gaps = [((side - opening) / 2.0, opening)] if joins or rng.random() < 0.4 else []
        if joins:
            old, new = group[other], group[i, j]
            group = {room: new if value == old else value for room, value in group.items()}
        corner = np.array(other) * side
        _wall(out, corner, corner + side * np.array([other[1] != j, other[0] != i]), gaps)
    _furnish_cells(rng, out, np.array(rooms) * side, side, None if alike else pieces)
    return BuildingPlan(out, np.full(2, side / 2.0, dtype=np.float64))


def _furnish_cells(rng: Generator, out: Outlines, rooms: Array, side: float, pieces: float | None) -> None:
    """Put furniture into square rooms of a side [m], whose lower corners are `rooms` (n, 2).

    About so many `pieces` into each, along its walls; None: one, of the same size and at the same place in all.
    """
    corner = 0.6 + 0.2 * rng.random(2)
    for low in rooms:
        if pieces is None:
            out.box(low + corner, 0.8, 0.5, 0.0)
            continue
        for _ in range(rng.poisson(pieces)):
            size = rng.uniform(0.2, 0.8, 2)
            along = np.where(rng.random(2) < 0.5, size / 2.0, side - size / 2.0) + rng.uniform(-0.05, 0.05, 2)
            out.box(low + along, size[0], size[1], rng.uniform(-0.2, 0.2))


def _hall(rng: Generator) -> BuildingPlan:
    """A large room with pillars, in rows or anywhere, and a few things on its floor."""
    out, high = Outlines(), rng.uniform((20.0, 15.0), (70.0, 50.0))
    out.polygon(_rectangle(np.zeros(2), high))
    pitch, wobble = rng.uniform(5.0, 14.0), float(rng.choice([0.0, 1.5]))
    round_, size = rng.random() < 0.5, rng.uniform(0.15, 0.5)
    for x in np.arange(pitch / 2.0, high[0], pitch):
        for y in np.arange(pitch / 2.0, high[1], pitch):
            place = np.clip(np.array([x, y]) + rng.normal(0.0, wobble, 2), 1.5, high - 1.5)
            if round_:
                out.ellipse(place, size, size)
            else:
                out.box(place, 2.0 * size, 2.0 * size, 0.0)
    for _ in range(rng.poisson(3.0)):
        out.box(rng.uniform(1.5, high - 1.5), rng.uniform(0.5, 4.0), rng.uniform(0.3, 1.5), rng.uniform(0.0, np.pi))
    return BuildingPlan(out, np.full(2, 0.5))


def _cave(rng: Generator) -> BuildingPlan:
    """Smooth free-form walls: the contour of a smooth random field, closed at the border."""
    size, smooth = rng.uniform((25.0, 20.0), (50.0, 40.0)), rng.uniform(1.5, 3.5)
    cols, rows = np.ceil(size / _FIELD_CELL).astype(int)
    field = np.asarray(ndimage.gaussian_filter(rng.standard_normal((rows, cols)), smooth / _FIELD_CELL))
    field = (field - np.quantile(field, rng.uniform(0.2, 0.4))) / field.std()
    from_border = np.minimum(*(np.minimum(k, k[::-1, ::-1]) for k in np.indices(field.shape)))
    field = np.where(from_border == 0, -1.0, field - 3.0 * np.exp(-from_border * _FIELD_CELL / 1.2))
    out = Outlines()
    for start, end in _contour(field):
        out.segment(start * _FIELD_CELL, end * _FIELD_CELL)
    parts = np.zeros(field.shape, dtype=np.int64)
    ndimage.label(field > 0.0, output=parts)
    largest = int(np.bincount(parts[parts > 0]).argmax())
    row, col = np.unravel_index(int(np.where(parts == largest, field, -np.inf).argmax()), field.shape)
    return BuildingPlan(out, np.array([col, row], dtype=np.float64) * _FIELD_CELL)


KINDS: dict[str, Callable[[Generator], BuildingPlan]] = {
    "office": _office,
    "loops": _loops,
    "cells": _cells,
    "hall": _hall,
    "cave": _cave,
}
"""How a floor of each kind is drawn."""


def _contour(field: Array) -> list[tuple[Array, Array]]:
    """Return the pieces (x, y), (x, y) of the contour of 0 between the cells of `field` (marching squares)."""
    above = field > 0.0
    mixed = above[:-1, :-1].astype(int) + above[1:, :-1] + above[:-1, 1:] + above[1:, 1:]
    pieces = []
    for row, col in np.argwhere((mixed > 0) & (mixed < 4)):
        ring = [(row, col), (row, col + 1), (row + 1, col + 1), (row + 1, col)]
        crossings = []
        for a, b in zip(ring, ring[1:] + ring[:1], strict=True):
            if above[a] != above[b]:
                share = field[a] / (field[a] - field[b])
                crossings.append((np.array(a) + share * (np.array(b) - np.array(a)))[::-1])
        pieces += [(crossings[k], crossings[k + 1]) for k in range(0, len(crossings), 2)]
    return pieces


def _rectangle(low: Array, high: Array) -> Array:
    return np.array([low, (high[0], low[1]), high, (low[0], high[1])])


def _cuts(rng: Generator, length: float, least: float, most: float) -> list[float]:
    """Return where a row of rooms is cut, from 0 to `length`."""
    edges = [0.0]
    while length - edges[-1] > least + most:
        edges.append(edges[-1] + rng.uniform(least, most))
    return [*edges, length]


def _wall(
    out: Outlines, start: tuple[float, float] | Array, end: tuple[float, float] | Array, gaps: list[tuple[float, float]]
) -> None:
    """Add a wall from `start` to `end` with `gaps` (begin, width) [m] along it, in any order."""
    a, b = np.asarray(start, dtype=np.float64), np.asarray(end, dtype=np.float64)
    length, angle = float(np.hypot(*(b - a))), float(np.arctan2(*(b - a)[::-1]))
    edges = [0.0, *(x for begin, width in sorted(gaps) for x in (begin, begin + width)), length]
    for low, high in zip(edges[::2], edges[1::2], strict=True):
        middle = a + 0.5 * (low + high) / length * (b - a)
        out.box(middle, high - low, _THICKNESS, angle)


def _furnish(rng: Generator, out: Outlines, low: Array, high: Array, door: Array) -> None:
    """Put something into a room, not before its door."""
    place, size = rng.uniform(low + 0.3, high - 0.3), rng.uniform((0.1, 0.1), (1.4, 0.8))
    angle, is_round = float(rng.choice([0.0, np.pi / 2.0, rng.uniform(0.0, np.pi)])), rng.random() < 0.2
    if np.hypot(*(place - door)) < 1.3 + 0.5 * float(np.hypot(*size)):
        return
    if is_round:
        out.ellipse(place, 0.5 * size[1], 0.5 * size[1])
    else:
        out.box(place, size[0], size[1], angle)
