"""What stands in the rooms of an office, and never before a door."""

from dataclasses import dataclass, field

import numpy as np

from .office_layout import OfficeLayout, Rectangle
from .solids import Solid, box, post

_DOOR_KEPT_FREE = 1.3


@dataclass
class _Room:
    """A room while it is being furnished: what is in it, and what must stay free."""

    floor: Rectangle
    taken: list[Rectangle]
    solids: list[Solid] = field(default_factory=list)

    def fits(self, place: Rectangle) -> bool:
        """Return whether nothing is at `place`, inside the room."""
        floor = self.floor
        inside = floor.x0 <= place.x0 and floor.y0 <= place.y0 and place.x1 <= floor.x1 and place.y1 <= floor.y1
        return inside and not any(
            place.x0 < other.x1 and other.x0 < place.x1 and place.y0 < other.y1 and other.y0 < place.y1
            for other in self.taken
        )

    def put(self, place: Rectangle, solids: list[Solid]) -> None:
        """Put `solids` at `place`, if it is free."""
        if self.fits(place):
            self.solids += solids
            self.taken.append(place)


def furniture(rng: np.random.Generator, layout: OfficeLayout) -> list[Solid]:
    """Return the furniture of all rooms and corridors."""
    solids: list[Solid] = []
    for floor in layout.rooms:
        room = _Room(floor, _kept_free(floor, layout.doors))
        wide, deep = floor.x1 - floor.x0, floor.y1 - floor.y0
        if wide > 9.0:
            _islands(rng, room)
        elif min(wide, deep) > 4.3 and rng.random() < 0.5:
            _meeting(rng, room)
        else:
            rng.choice(np.array([_desks, _lounge, _store], dtype=object))(rng, room)
        _odds_and_ends(rng, room)
        solids += room.solids
    for floor in layout.corridors:
        room = _Room(floor, [*_kept_free(floor, layout.doors), *_crossings(floor, layout.corridors)])
        if min(floor.x1 - floor.x0, floor.y1 - floor.y0) >= 2.2:
            _odds_and_ends(rng, room, deepest=0.4)
        solids += room.solids
    return solids


def _kept_free(floor: Rectangle, doors: tuple[Rectangle, ...]) -> list[Rectangle]:
    """Return the places before the doors of a room."""
    reach = _DOOR_KEPT_FREE
    grown = [Rectangle(d.x0 - 0.25, d.y0 - 0.25, d.x1 + 0.25, d.y1 + 0.25) for d in doors]
    near = [d for d in grown if d.x0 < floor.x1 and floor.x0 < d.x1 and d.y0 < floor.y1 and floor.y0 < d.y1]
    return [
        Rectangle(d.x0, d.y0 - reach, d.x1, d.y1 + reach)
        if d.x1 - d.x0 > d.y1 - d.y0
        else Rectangle(d.x0 - reach, d.y0, d.x1 + reach, d.y1)
        for d in near
    ]


def _crossings(floor: Rectangle, corridors: tuple[Rectangle, ...]) -> list[Rectangle]:
    return [other for other in corridors if other is not floor]


def _along_wall(rng: np.random.Generator, floor: Rectangle, size: float, depth: float) -> tuple[Rectangle, int]:
    """Return a place of `size` by `depth` [m] at one of the four walls, and the wall: left, right, lower, upper."""
    wall = int(rng.integers(4))
    if wall < 2:
        y = rng.uniform(floor.y0, max(floor.y0, floor.y1 - size))
        x = floor.x0 if wall == 0 else floor.x1 - depth
        return Rectangle(x, y, x + depth, y + size), wall
    x = rng.uniform(floor.x0, max(floor.x0, floor.x1 - size))
    y = floor.y0 if wall == 2 else floor.y1 - depth
    return Rectangle(x, y, x + size, y + depth), wall


def _desks(rng: np.random.Generator, room: _Room) -> None:
    """Put one to four desks with chairs along the walls."""
    for _ in range(int(rng.integers(1, 5))):
        place, wall = _along_wall(rng, room.floor, rng.uniform(1.2, 1.7), rng.uniform(1.25, 1.4))
        x, y = place.middle
        top = {
            0: Rectangle(place.x0, place.y0, place.x0 + 0.75, place.y1),
            1: Rectangle(place.x1 - 0.75, place.y0, place.x1, place.y1),
            2: Rectangle(place.x0, place.y0, place.x1, place.y0 + 0.75),
            3: Rectangle(place.x0, place.y1 - 0.75, place.x1, place.y1),
        }[wall]
        seat = {0: (place.x0 + 1.0, y), 1: (place.x1 - 1.0, y), 2: (x, place.y0 + 1.0), 3: (x, place.y1 - 1.0)}[wall]
        room.put(place, [*_table(rng, top), *_chair(rng, *seat)])


def _meeting(rng: np.random.Generator, room: _Room) -> None:
    """Put a table with chairs in the middle, with a way round it."""
    floor = room.floor
    x, y = floor.middle
    half_x = min((floor.x1 - floor.x0) / 2.0 - 1.75, rng.uniform(0.5, 1.6))
    half_y = min((floor.y1 - floor.y0) / 2.0 - 1.75, rng.uniform(0.4, 0.8))
    half_x, half_y = max(half_x, 0.35), max(half_y, 0.35)
    solids = _table(rng, Rectangle(x - half_x, y - half_y, x + half_x, y + half_y))
    for side in (-1.0, 1.0):
        for at in np.arange(-half_x + 0.35, half_x - 0.2, 0.75):
            if rng.random() < 0.8:
                solids += _chair(rng, x + float(at), y + side * (half_y + 0.1))
    room.put(Rectangle(x - half_x, y - half_y - 0.35, x + half_x, y + half_y + 0.35), solids)


def _lounge(rng: np.random.Generator, room: _Room) -> None:
    """Put a sofa and a low table, and a round table."""
    place, _ = _along_wall(rng, room.floor, rng.uniform(1.5, 2.2), 0.85)
    room.put(place, [box("sofa", (place.x0, place.y0), (place.x1, place.y1), top=0.75)])
    x, y = room.floor.middle
    x, y = x + rng.uniform(-0.3, 0.3), y + rng.uniform(-0.3, 0.3)
    radius = rng.uniform(0.35, 0.5)
    table = Solid(kind="table", x=x, y=y, radius=radius, bottom=0.7, top=0.75)
    leg = post("table leg", x, y, rng.uniform(0.04, 0.07), 0.7, blocks_people=False)
    room.put(Rectangle(x - radius, y - radius, x + radius, y + radius), [table, leg])


def _store(rng: np.random.Generator, room: _Room) -> None:
    """Put shelves along the walls."""
    for _ in range(int(rng.integers(2, 6))):
        place, _ = _along_wall(rng, room.floor, rng.uniform(1.0, 2.4), rng.uniform(0.35, 0.6))
        room.put(place, [box("cabinet", (place.x0, place.y0), (place.x1, place.y1), rng.uniform(0.8, 2.0))])


def _islands(rng: np.random.Generator, room: _Room) -> None:
    """Put groups of four desks in a large hall, with lanes between them."""
    floor = room.floor
    size, depth = rng.uniform(1.3, 1.6), 0.75
    for x in np.arange(floor.x0 + 2.6, floor.x1 - 2.0, 2.0 * size + rng.uniform(1.9, 2.3)):
        y = (floor.y0 + floor.y1) / 2.0 + rng.uniform(-0.15, 0.15)
        place = Rectangle(x - size, y - depth - 0.45, x + size, y + depth + 0.45)
        solids: list[Solid] = []
        for side in (-1.0, 1.0):
            for part in (-1.0, 1.0):
                low, high = sorted((0.0, side * depth))
                left, right = sorted((0.0, part * size))
                solids += _table(rng, Rectangle(x + left, y + low, x + right, y + high))
                if rng.random() < 0.75:
                    solids += _chair(rng, x + part * size / 2.0, y + side * (depth + 0.15))
        room.put(place, solids)


def _odds_and_ends(rng: np.random.Generator, room: _Room, deepest: float = 0.5) -> None:
    """Put plants, bins and cabinets at the walls."""
    floor = room.floor
    for _ in range(int(rng.integers(0, 2 + int(floor.x1 - floor.x0 + floor.y1 - floor.y0) // 5))):
        if rng.random() < 0.5:
            depth = rng.uniform(0.25, deepest)
            place, _ = _along_wall(rng, floor, depth, depth)
            x, y = place.middle
            room.put(place, [post("plant" if rng.random() < 0.5 else "bin", x, y, depth / 2.0, rng.uniform(0.5, 1.3))])
        else:
            place, _ = _along_wall(rng, floor, rng.uniform(0.6, 1.4), rng.uniform(0.3, deepest))
            room.put(place, [box("cabinet", (place.x0, place.y0), (place.x1, place.y1), rng.uniform(0.6, 1.9))])


def _table(rng: np.random.Generator, top: Rectangle) -> list[Solid]:
    """Return a table top over the laser's plane and its four legs."""
    inset, radius = 0.08, rng.uniform(0.02, 0.04)
    corners = [(x, y) for x in (top.x0 + inset, top.x1 - inset) for y in (top.y0 + inset, top.y1 - inset)]
    legs = [post("table leg", x, y, radius, 0.7, blocks_people=False) for x, y in corners]
    return [box("table", (top.x0, top.y0), (top.x1, top.y1), top=0.75, bottom=0.7), *legs]


def _chair(rng: np.random.Generator, x: float, y: float) -> list[Solid]:
    """Return an office chair on one post, turned anyhow."""
    yaw = rng.uniform(-np.pi, np.pi)
    seat = Solid(kind="chair", x=x, y=y, yaw=yaw, half_length=0.21, half_width=0.21, bottom=0.42, top=0.48)
    return [seat, post("chair leg", x, y, 0.035, 0.42, blocks_people=False)]
