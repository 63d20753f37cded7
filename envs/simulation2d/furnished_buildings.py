"""Random buildings for the laser to look at: rooms with doors, furniture, poles and clutter, at shin height."""

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from .outlines import Outlines, cast, turned


def draw_building(rng: Generator, centre_size: float) -> Outlines:
    """Draw a building around the origin; rooms are about `centre_size` [m] wide."""
    outlines = Outlines()
    size = centre_size * rng.uniform(1.5, 4.0, 2)
    low = -size * rng.uniform(0.25, 0.75, 2)
    heading = rng.uniform(-np.pi, np.pi)
    rooms = _split(rng, low, low + size, centre_size, outlines, heading)
    clutter = rng.choice([0.0, 0.1, 0.3, 1.0], p=[0.15, 0.3, 0.3, 0.25])
    for a, b in rooms:
        area = float(np.prod(b - a))
        for _ in range(min(rng.poisson(0.25 * clutter * area), 40)):
            _furnish(rng, a, b, heading, outlines)
    if rng.random() < 0.15:
        _railing(rng, outlines)
    return outlines


def draw_decoys(rng: Generator, building: Outlines, reach: float, heading: float) -> Outlines:
    """Draw things of about the size of legs where the laser sees them, as people stand: bins, wheels, bags, feet."""
    decoys = Outlines()
    pieces = (_low_box, _low_box, _round, _wheel, _pole, _chair, _swivel_chair, _cart, _rubble)
    for _ in range(rng.poisson(2.0)):
        direction = heading + rng.uniform(-2.2, 2.2)
        seen, _ = cast(np.zeros((1, 2)), np.array([direction]), reach, *building.arrays())
        distance = rng.uniform(0.4, max(min(seen[0], reach) - 0.1, 0.5))
        place = distance * np.array([np.cos(direction), np.sin(direction)])
        pieces[rng.integers(len(pieces))](rng, place, rng.uniform(-np.pi, np.pi), decoys)
    return decoys


def _low_box(rng: Generator, place: NDArray[np.float64], angle: float, out: Outlines) -> None:
    """A box or bag with rounded edges."""
    length, width = rng.uniform(0.15, 0.5), rng.uniform(0.08, 0.4)
    bevel = rng.uniform(0.0, 0.45) * min(length, width)
    x, y = np.array([length, length - 2 * bevel]) / 2, np.array([width - 2 * bevel, width]) / 2
    quarter = np.stack((x, y), axis=1)
    half = np.concatenate((quarter, quarter[::-1] * (-1.0, 1.0)))
    out.polygon(place + turned(np.concatenate((half, -half)), angle))


def _wheel(rng: Generator, place: NDArray[np.float64], angle: float, out: Outlines) -> None:
    out.ellipse(place, rng.uniform(0.05, 0.3), rng.uniform(0.01, 0.04), angle)


def draw_screens(rng: Generator, heading: float) -> Outlines:
    """Draw things close to the laser with a gap towards `heading`, as when it looks out between furniture or doors."""
    screens = Outlines()
    distance, gap = rng.uniform(0.3, 1.6), rng.uniform(0.2, 1.2)
    tilt = heading + np.pi / 2 + rng.normal(0.0, 0.3)
    along = np.array([np.cos(tilt), np.sin(tilt)])
    middle = distance * np.array([np.cos(heading), np.sin(heading)])
    for side in (-1.0, 1.0):
        length, thickness = rng.uniform(0.05, 3.0), rng.uniform(0.02, 0.5)
        if rng.random() < 0.8:
            screens.box(middle + side * along * (gap + length) / 2, length, thickness, tilt + rng.normal(0.0, 0.1))
    return screens


def _split(
    rng: Generator, low: NDArray[np.float64], high: NDArray[np.float64], room: float, out: Outlines, heading: float
) -> list[tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """Cut a rectangle into rooms, walls with doors between them; return the rooms (two corners each)."""
    _wall_box(rng, low, high, out, heading)
    rooms, done = [(low, high)], []
    while rooms:
        a, b = rooms.pop()
        axis = int(np.argmax(b - a))
        if (b - a)[axis] < room * rng.uniform(1.0, 2.5) or len(rooms) + len(done) > 14:
            done.append((a, b))
            continue
        cut = a[axis] + (b - a)[axis] * rng.uniform(0.25, 0.75)
        start, end = a.copy(), b.copy()
        start[axis] = end[axis] = cut
        _wall(rng, start, end, out, heading, doors=int(rng.integers(1, 3)))
        upper, lower = a.copy(), b.copy()
        upper[axis] = lower[axis] = cut
        rooms += [(a, lower), (upper, b)]
    return done


def _wall_box(rng: Generator, a: NDArray[np.float64], b: NDArray[np.float64], out: Outlines, heading: float) -> None:
    corners = np.array([[a[0], a[1]], [b[0], a[1]], [b[0], b[1]], [a[0], b[1]]])
    for i in range(4):
        _wall(rng, corners[i], corners[(i + 1) % 4], out, heading, doors=int(rng.integers(0, 2)))


def _wall(
    rng: Generator, start: NDArray[np.float64], end: NDArray[np.float64], out: Outlines, heading: float, doors: int
) -> None:
    """A wall of some thickness with door gaps, frames, recesses, radiators and pipes along it."""
    length = float(np.hypot(*(end - start)))
    along = (end - start) / max(length, 1e-6)
    across = np.array([-along[1], along[0]])
    thickness = rng.uniform(0.05, 0.3)
    lost = float(rng.choice([0.0, 0.4], p=[0.95, 0.05]))
    gaps = sorted((float(g), float(g + rng.uniform(0.5, 1.6))) for g in rng.uniform(0.0, max(length - 0.6, 0.1), doors))
    edges = [0.0, *(x for gap in gaps for x in gap), length]
    for s, e in zip(edges[::2], edges[1::2], strict=True):
        if e - s < 0.02:
            continue
        if rng.random() < 0.15:
            _posts(rng, start + s * along, along, e - s, out, heading)
            continue
        p, q = start + s * along, start + e * along
        corners = np.array([p - across * thickness / 2, q - across * thickness / 2])
        out.polygon(turned(np.concatenate((corners, corners[::-1] + across * thickness)), heading), lost)
        _along_wall(rng, p, along, across, e - s, thickness, out, heading)
    for s, e in gaps:
        if rng.random() < 0.4:  # an open door leaf
            hinge = start + (s if rng.random() < 0.5 else e) * along
            swing = turned(along[None] * (e - s), rng.uniform(-np.pi, np.pi))[0]
            out.polygon(turned(np.array([hinge, hinge + swing]), heading), closed=False)


def _posts(
    rng: Generator,
    start: NDArray[np.float64],
    along: NDArray[np.float64],
    length: float,
    out: Outlines,
    heading: float,
) -> None:
    """A wall of glass, of which only the posts and some pieces give returns."""
    pitch = rng.uniform(0.25, 1.5)
    angle = heading + np.arctan2(along[1], along[0])
    width, thickness = rng.uniform(0.03, 0.3, 2)
    for k in range(int(length / pitch)):
        place = turned((start + (k + rng.uniform(0.3, 0.7)) * pitch * along)[None], heading)[0]
        out.box(place, width * rng.uniform(0.5, 1.5), thickness, angle)


def _along_wall(
    rng: Generator,
    start: NDArray[np.float64],
    along: NDArray[np.float64],
    across: NDArray[np.float64],
    length: float,
    thickness: float,
    out: Outlines,
    heading: float,
) -> None:
    """Things that stand on a wall: pilasters, frames, pipes, radiators, cupboards, skirting that steps back."""
    for _ in range(rng.poisson(rng.uniform(0.0, 0.5) * length)):
        side = across * (thickness / 2) * rng.choice([-1.0, 1.0])
        place = start + along * rng.uniform(0.0, length) + side
        spot = turned(place[None], heading)[0]
        angle = heading + np.arctan2(along[1], along[0])
        kind = rng.integers(4)
        if kind == 0:
            out.box(spot, rng.uniform(0.05, 0.6), rng.uniform(0.04, 0.5), angle)
        elif kind == 1:
            radius = rng.uniform(0.015, 0.08)
            out.ellipse(spot, radius, radius)
        elif kind == 2:
            for k in range(int(rng.integers(3, 12))):
                rib = place + along * 0.06 * k + side / max(thickness, 0.05) * rng.uniform(0.1, 0.2)
                out.box(turned(rib[None], heading)[0], 0.03, 0.08, angle)
        else:
            out.box(spot, rng.uniform(0.3, 1.5), rng.uniform(0.2, 0.8), angle)


def _furnish(rng: Generator, a: NDArray[np.float64], b: NDArray[np.float64], heading: float, out: Outlines) -> None:
    """Put one piece of furniture into a room."""
    place = turned(rng.uniform(a, b)[None], heading)[0]
    angle = heading + float(rng.choice([0.0, np.pi / 2, rng.uniform(-np.pi, np.pi)]))
    pieces = (_table, _chair, _chair, _swivel_chair, _box, _round, _pole, _cart, _rubble, _plant, _sofa)
    pieces[rng.integers(len(pieces))](rng, place, angle, out)


def _feet(rng: Generator, place: NDArray[np.float64], sides: NDArray[np.float64], angle: float, out: Outlines) -> None:
    """Four round, square or flat feet at the corners of a rectangle."""
    corners = place + turned(np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) * 0.5 * sides, angle)
    size = rng.uniform(0.01, 0.045)
    style = rng.integers(3)
    lost = float(rng.choice([0.0, 0.2]))
    for corner in corners:
        if style == 0:
            out.ellipse(corner, size, size, lost=lost)
        else:
            out.box(corner, 2 * size, 2 * size if style == 1 else 0.02, angle, lost)


def _table(rng: Generator, place: NDArray[np.float64], angle: float, out: Outlines) -> None:
    _feet(rng, place, rng.uniform((0.5, 0.4), (2.5, 1.2)), angle, out)


def _chair(rng: Generator, place: NDArray[np.float64], angle: float, out: Outlines) -> None:
    _feet(rng, place, rng.uniform(0.33, 0.55, 2), angle, out)


def _swivel_chair(rng: Generator, place: NDArray[np.float64], angle: float, out: Outlines) -> None:
    out.ellipse(place, 0.03, 0.03)
    for k in range(5):
        tip = place + turned(np.array([[rng.uniform(0.25, 0.33), 0.0]]), angle + k * 2 * np.pi / 5)[0]
        out.segment(place, tip, 0.1)
        out.ellipse(tip, 0.03, 0.02, angle)


def _box(rng: Generator, place: NDArray[np.float64], angle: float, out: Outlines) -> None:
    out.box(place, rng.uniform(0.1, 1.2), rng.uniform(0.1, 0.7), angle)


def _round(rng: Generator, place: NDArray[np.float64], angle: float, out: Outlines) -> None:
    out.ellipse(place, rng.uniform(0.09, 0.35), rng.uniform(0.09, 0.35), angle)


def _pole(rng: Generator, place: NDArray[np.float64], angle: float, out: Outlines) -> None:
    radius = rng.uniform(0.01, 0.15)
    out.ellipse(place, radius, radius * rng.uniform(0.5, 1.0), angle)


def _cart(rng: Generator, place: NDArray[np.float64], angle: float, out: Outlines) -> None:
    """Wheels of a trolley or wheelchair: short flat pieces, and sometimes a frame between them."""
    sides = rng.uniform((0.4, 0.3), (1.1, 0.7))
    corners = place + turned(np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) * 0.5 * sides, angle)
    for k, corner in enumerate(corners):
        out.ellipse(corner, rng.uniform(0.04, 0.3 if k < 2 else 0.08), rng.uniform(0.012, 0.03), angle)
    if rng.random() < 0.5:
        out.segment(corners[0], corners[1], 0.3)


def _rubble(rng: Generator, place: NDArray[np.float64], angle: float, out: Outlines) -> None:
    """Short crooked pieces: bags, cables, the edge of things that the plane of the laser just touches."""
    for _ in range(int(rng.integers(1, 4))):
        steps = rng.normal(0.0, rng.uniform(0.03, 0.2), (int(rng.integers(1, 4)), 2))
        out.polygon(place + np.cumsum(steps, axis=0) + rng.normal(0.0, 0.3, 2), rng.uniform(0, 0.4), closed=False)


def _plant(rng: Generator, place: NDArray[np.float64], angle: float, out: Outlines) -> None:
    for _ in range(int(rng.integers(3, 12))):
        leaf = rng.normal(place, 0.12)
        out.ellipse(leaf, rng.uniform(0.005, 0.05), rng.uniform(0.004, 0.01), rng.uniform(0.0, np.pi), lost=0.2)


def _sofa(rng: Generator, place: NDArray[np.float64], angle: float, out: Outlines) -> None:
    out.box(place, rng.uniform(0.7, 2.2), rng.uniform(0.5, 0.9), angle)
    for side in (-1.0, 1.0):
        arm = place + turned(np.array([[side * rng.uniform(0.5, 1.1), 0.3]]), angle)[0]
        out.ellipse(arm, 0.12, rng.uniform(0.1, 0.3), angle)


def _railing(rng: Generator, out: Outlines) -> None:
    start, angle = rng.uniform(-4.0, 4.0, 2), rng.uniform(-np.pi, np.pi)
    pitch, radius = rng.uniform(0.1, 1.0), rng.uniform(0.008, 0.04)
    for k in range(int(rng.integers(4, 20))):
        post = start + pitch * k * np.array([np.cos(angle), np.sin(angle)])
        out.ellipse(post, radius, radius)
