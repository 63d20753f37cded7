"""Campus corridors drawn at random: long stretches that look alike, and drives of kilometres through them.

Corridors run between the junctions of a grid; some are missing. Doors stand at even distances in the walls of all of
them alike; only some corridors have recesses of their own, by which they can be told from the others.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from ...slam.scan import LaserScan
from .drawn_drives import ODOMETRY, drive_along, wheel_odometry
from .outlines import Outlines
from .sweep_kernel import sweep

Array = NDArray[np.float64]

LEAST_SIZE = 20.0
"""Least length of a campus [m]."""
BEAMS = 180
REACH = 50.0
"""Of the laser [m]."""
_SPEED = 1.15  # [m/s]; with ten scans a second about 8700 scans a kilometre, as of a recorded campus
_STEP_S, _EVERY = 0.05, 2  # of the motion [s]; steps between two scans
_NOISE = 0.02  # standard deviation of a range [m]
_RANGE_MIN = 0.05  # [m]
_MISSING = 0.25  # share of the corridors of the grid that are not there
_OWN = 0.3  # share of the corridors with recesses of their own
_AGAIN = 5.0  # way after which the walls within reach are collected again [m]
_SWAY, _SWAY_EVERY = 0.15, 8.0  # standard deviation of the robot's place across a corridor; how often it changes [m]


@dataclass(frozen=True, eq=False)
class Campus:
    """A floor of corridors.

    Attributes:
        outlines: Its walls.
        junctions: (k, 2) where corridors meet [m].
        links: (l, 2) the junctions at the ends of each corridor.
    """

    outlines: Outlines
    junctions: Array
    links: NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class CampusDrive:
    """A drive through a campus, whose scans are taken one by one: they are too many to be kept.

    Attributes:
        campus: Where.
        truth: (n, 3) T_plan_robot of each scan.
        odometry: (n, 3) T_odom_robot.
        seed: Of the noise of the laser.
    """

    campus: Campus
    truth: Array
    odometry: Array
    seed: int

    def __len__(self) -> int:
        return len(self.truth)

    def scans(self) -> Iterator[LaserScan]:
        """Yield the scan at each pose; the same ones each time."""
        rng = np.random.default_rng([self.seed, 1])
        _, walls = self.campus.outlines.arrays()
        bearings = (np.arange(BEAMS) + 0.5) * np.pi / BEAMS - 0.5 * np.pi
        centre, near, nothing = np.full(2, np.inf), walls, np.zeros((0, 7))
        for k, (x, y, heading) in enumerate(self.truth.tolist()):
            if np.hypot(x - centre[0], y - centre[1]) > _AGAIN:
                centre = np.array([x, y])
                near = walls[_distances(walls, centre) <= REACH + _AGAIN]
            ranges = sweep(x, y, heading + bearings, REACH, nothing, near)
            ranges = np.maximum(ranges + rng.normal(0.0, _NOISE, BEAMS), _RANGE_MIN)
            yield LaserScan(ranges, bearings, _RANGE_MIN, REACH, k * _EVERY * _STEP_S)


def draw_campus_drive(size: float, way: float, seed: int) -> CampusDrive:
    """Draw a campus of a length `size` [m], and a drive of `way` [m] through it; the same to the byte for one seed."""
    rng = np.random.default_rng([seed, round(size)])
    campus = draw_campus(size, rng)
    motion = drive_along(walk(campus, way, rng), _SPEED, float(rng.uniform(-np.pi, np.pi)))
    odometry = wheel_odometry(motion, _EVERY, ODOMETRY["typical"], rng)
    return CampusDrive(campus, motion[::_EVERY], odometry, seed)


def draw_campus(size: float, rng: Generator) -> Campus:
    """Draw a campus of a length `size` of at least `LEAST_SIZE` [m], about half as wide."""
    width, block = float(rng.uniform(2.0, 3.2)), float(rng.uniform(25.0, 50.0))
    extent = np.array([size, size * rng.uniform(0.3, 0.6)]) - width
    count = np.maximum(np.rint(extent / block), 1).astype(int) + 1
    pitch = np.array([extent[0] / (count[0] - 1), block if count[1] > 2 else min(block, extent[0])])
    grid = np.stack(np.meshgrid(np.arange(count[0]), np.arange(count[1]), indexing="ij"), axis=-1).reshape(-1, 2)
    junctions = grid * pitch
    links = _drawn_links(count, rng)
    out, doors = Outlines(), float(rng.uniform(4.0, 8.0))
    door = (float(rng.uniform(0.9, 1.3)), float(rng.uniform(0.08, 0.25)))
    open_sides = {(int(a), tuple(np.sign(grid[b] - grid[a]).tolist())) for a, b in (*links, *links[:, ::-1])}
    for k, place in enumerate(junctions):
        for side in ((1, 0), (0, 1), (-1, 0), (0, -1)):
            if (k, side) not in open_sides:
                along, across = np.array(side, dtype=np.float64), np.array((-side[1], side[0]), dtype=np.float64)
                out.segment(place + 0.5 * width * (along - across), place + 0.5 * width * (along + across))
    for a, b in links:
        _corridor(out, junctions[a], junctions[b], width, doors, door, rng if rng.random() < _OWN else None)
    return Campus(out, junctions, links)


def walk(campus: Campus, least: float, rng: Generator) -> Array:
    """Return (n, 2) a way of at least `least` [m] from junction to junction, turning back only at dead ends."""
    beside: dict[int, list[int]] = {}
    for a, b in campus.links.tolist():
        beside.setdefault(a, []).append(b)
        beside.setdefault(b, []).append(a)
    before, here, length = -1, int(campus.links[0, 0]), 0.0
    points = [campus.junctions[here]]
    while length < least:
        choices = [k for k in beside[here] if k != before] or beside[here]
        before, here = here, choices[int(rng.integers(len(choices)))]
        start, end = campus.junctions[before], campus.junctions[here]
        far = float(np.hypot(*(end - start)))
        across = np.array([start[1] - end[1], end[0] - start[0]]) / far
        for share in np.arange(_SWAY_EVERY, far - 0.5 * _SWAY_EVERY, _SWAY_EVERY) / far:
            points.append(start + share * (end - start) + rng.normal(0.0, _SWAY) * across)
        points.append(end)
        length += far
    return np.array(points)


def _drawn_links(count: NDArray[np.int64], rng: Generator) -> NDArray[np.int64]:
    """Return (l, 2) which junctions of a grid of `count` (2,) are joined: all of them hang together."""
    number = np.arange(count[0] * count[1]).reshape(count)
    pairs = [(number[:-1], number[1:]), (number[:, :-1], number[:, 1:])]
    links = np.concatenate([np.stack((a.ravel(), b.ravel()), axis=-1) for a, b in pairs])
    if len(links) == 4:
        return links  # a single ring stays one
    group = np.arange(number.size)
    kept = []
    for a, b in links[rng.permutation(len(links))]:
        if group[a] != group[b] or rng.random() >= 2.0 * _MISSING:
            kept.append((a, b))
            group[group == group[b]] = group[a]
    return np.array(kept)


def _corridor(
    out: Outlines,
    start: Array,
    end: Array,
    width: float,
    doors: float,
    door: tuple[float, float],
    rng: Generator | None,
) -> None:
    """Add both walls of a corridor from junction to junction, with doors, and recesses of its own if there is `rng`.

    Args:
        out: What they are added to.
        start: (2,) middle of a junction [m].
        end: (2,) middle of the other [m].
        width: Of the corridor [m].
        doors: Distance of the doors [m].
        door: Width and depth of a door's recess [m].
        rng: Draws the recesses.
    """
    far = float(np.hypot(*(end - start)))
    along = (end - start) / far
    across, length = np.array([-along[1], along[0]]), far - width
    for side in (-1.0, 1.0):
        recesses = [(s, s + door[0], door[1]) for s in np.arange(0.5 * doors, length - door[0], doors)]
        if rng is not None:
            recesses = [(s, e, depth) for s, e, depth in recesses if rng.random() < 0.5]
            starts = np.sort(rng.uniform(0.5, length - 3.0, rng.poisson(length / 12.0)))
            recesses += [(s, s + rng.uniform(0.4, 2.5), rng.uniform(0.1, 0.8)) for s in starts]
        corners, reached = [(0.0, 0.0)], 0.0
        for s, e, depth in sorted(recesses):
            if s > reached + 0.1:
                corners += [(s, 0.0), (s, depth), (e, depth), (e, 0.0)]
                reached = e
        corners.append((length, 0.0))
        origin = start + 0.5 * width * along + side * 0.5 * width * across
        for (s0, d0), (s1, d1) in pairwise(corners):
            out.segment(origin + s0 * along + side * d0 * across, origin + s1 * along + side * d1 * across)


def _distances(walls: Array, place: Array) -> Array:
    """Return (m,) how far each of `walls` (m, 6) is from a place (2,) at least [m]."""
    start, way = walls[:, :2], walls[:, 2:4] - walls[:, :2]
    share = np.clip(((place - start) * way).sum(axis=1) / np.maximum((way**2).sum(axis=1), 1e-12), 0.0, 1.0)
    return np.linalg.norm(start + share[:, None] * way - place, axis=1)
