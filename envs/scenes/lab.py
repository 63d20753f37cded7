"""A laboratory after Fig. 8 of Zhang et al. 2019: a room full of furniture, and a passage behind its front door.

Its marks are the paper's: a, boxes behind a screen in one corner; b, boxes in another corner; c, the front door;
d, two people who stand still all the time; e, somebody who stands near the door, opens it and walks out to f; g, where
somebody who walks in the passage comes to a stop.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from .polyline import arc_lengths, resample, rounded, tangents
from .scene import RUN_OUT, Door, Errand, OperatorPlan, Scene, choose_route
from .solids import Solid, box, post

Array = NDArray[np.float64]

CEILING = 2.6
"""Height of the ceiling [m]."""
LEAVES_AT = 215.0
"""When the person near the door walks to it [s]."""
STOPS_AT = 235.0
"""About when the person in the passage stops for good [s]."""
_WALL = 0.15
_PASSAGE = 2.7
_DOOR = 1.2


def lab(rng: np.random.Generator, route: str | None = None) -> Scene:
    """Return a room of about 9 x 7 m with desks, chairs, screens and boxes, and a passage of 15 x 2.7 m.

    Routes: "tour" (once round the room, out of the door, along the passage) and "operator" (twice round the room).
    """
    length, depth = 9.0 + rng.uniform(-0.3, 0.5), 7.0 + rng.uniform(-0.2, 0.4)
    door = length - 1.5 + rng.uniform(-0.15, 0.15)
    lanes = (1.75, door - 0.25, 1.15, depth - 1.5)
    solids = [
        *_walls(length, depth, door),
        *_desks(rng, lanes, depth),
        *_corner_a(rng, depth),
        *_corner_b(rng, length, depth),
    ]
    routes = _routes(lanes, door)
    name = choose_route(routes, route, rng)
    standing = (np.array([length - 0.55, depth / 2.0]), np.array([lanes[1] - 0.9, depth - 0.5]))
    errands = _errands(rng, standing, np.array([length - 0.5, 1.5]), door)
    scene = Scene(
        name="lab",
        solids=tuple(solids),
        floor=_floor(length, depth, door),
        routes=routes,
        route_name=name,
        lap=0.0,
        half_width=0.55,
        standing_places=_standing_places(solids, routes[name]),
        ceiling=CEILING,
        doors=(Door(hinge=(door + _DOOR / 2.0, -_WALL), yaw=np.pi, swing=2.85, width=_DOOR),),
        errands=errands,
        operator=_operator(routes["operator"], door),
        marks=_marks(length, depth, door, errands),
    )
    return scene


def _walls(length: float, depth: float, door: float) -> list[Solid]:
    west, east, south = -4.0, length + 2.0, -_WALL - _PASSAGE
    left, right = door - _DOOR / 2.0, door + _DOOR / 2.0
    return [
        box("wall", (-_WALL, depth), (length + _WALL, depth + _WALL), CEILING),
        box("wall", (-_WALL, 0.0), (0.0, depth), CEILING),
        box("wall", (length, 0.0), (length + _WALL, depth), CEILING),
        box("wall", (west, -_WALL), (left, 0.0), CEILING),
        box("wall", (right, -_WALL), (east, 0.0), CEILING),
        replace(box("wall", (left, -_WALL), (right, 0.0), CEILING, bottom=2.07), blocks_people=False),
        box("wall", (west - _WALL, south - _WALL), (east + _WALL, south), CEILING),
        box("wall", (west - _WALL, south), (west, 0.0), CEILING),
        box("wall", (east, south), (east + _WALL, 0.0), CEILING),
    ]


def _desk(low: tuple[float, float], high: tuple[float, float], top: float = 0.72) -> list[Solid]:
    """Return a table top on four legs."""
    legs = [
        post("table leg", x, y, 0.025, top - 0.03, blocks_people=False)
        for x in (low[0] + 0.06, high[0] - 0.06)
        for y in (low[1] + 0.06, high[1] - 0.06)
    ]
    return [box("table", low, high, top=top, bottom=top - 0.03), *legs]


def _chair(x: float, y: float, yaw: float) -> list[Solid]:
    """Return a chair on one post; `yaw` points from its back to its front [rad]."""
    cos, sin = np.cos(yaw), np.sin(yaw)
    seat = Solid(kind="chair", x=x, y=y, yaw=yaw, half_length=0.22, half_width=0.22, bottom=0.42, top=0.47)
    back = Solid(
        kind="chair back",
        x=x - 0.21 * cos,
        y=y - 0.21 * sin,
        yaw=yaw,
        half_length=0.02,
        half_width=0.2,
        bottom=0.55,
        top=0.9,
        blocks_people=False,
    )
    return [seat, back, post("chair leg", x, y, 0.04, 0.42, blocks_people=False)]


def _desks(rng: np.random.Generator, lanes: tuple[float, float, float, float], depth: float) -> list[Solid]:
    """Return an island of four desks with a low screen along it, a desk at the west wall and one at the north wall."""
    west, east, south, north = lanes
    middle, across = (west + east) / 2.0, (south + north) / 2.0
    half = min(1.5, (east - west) / 2.0 - 0.9) - rng.uniform(0.0, 0.1)
    solids: list[Solid] = []
    for left, right in ((middle - half, middle - 0.01), (middle + 0.01, middle + half)):
        solids += _desk((left, across - 0.7), (right, across - 0.03))
        solids += _desk((left, across + 0.03), (right, across + 0.7))
    solids.append(box("screen", (middle - half, across - 0.02), (middle + half, across + 0.02), 1.15, bottom=0.1))
    for x in (middle - half / 2.0, middle + half / 2.0):
        for side in (-1.0, 1.0):
            turn = -side * np.pi / 2.0 + rng.uniform(-0.5, 0.5)
            solids += _chair(x + rng.uniform(-0.2, 0.2), across + side * (0.78 + rng.uniform(0.0, 0.1)), turn)
    solids += _desk((0.02, 1.7), (0.68, 3.3 + rng.uniform(-0.2, 0.2)))
    solids += _chair(0.8, 2.4 + rng.uniform(-0.2, 0.2), np.pi + rng.uniform(-0.4, 0.4))
    solids += _desk((middle - 1.0, depth - 0.7), (middle + 0.6, depth - 0.02))
    solids += _chair(middle - 0.2 + rng.uniform(-0.3, 0.3), depth - 0.78, np.pi / 2.0 + rng.uniform(-0.4, 0.4))
    solids.append(box("cabinet", (0.0, 0.0), (0.45, 0.9 + rng.uniform(0.0, 0.3)), rng.uniform(1.2, 1.9)))
    return solids


def _corner_a(rng: np.random.Generator, depth: float) -> list[Solid]:
    """Return boxes behind a folding screen that is higher than the laser and lower than the view to the walls."""
    top, front = rng.uniform(1.25, 1.4), depth - 1.55
    side = 1.5 + rng.uniform(0.0, 0.1)
    return [
        box("screen", (0.0, front - 0.02), (side, front + 0.02), top),
        box("screen", (side - 0.02, front), (side + 0.02, depth - 0.75), top),
        box("carton", (0.15, depth - 0.6), (0.65, depth - 0.15), rng.uniform(0.4, 0.6)),
        box("carton", (0.85, depth - 0.55), (1.25, depth - 0.1), rng.uniform(0.6, 0.9)),
    ]


def _corner_b(rng: np.random.Generator, length: float, depth: float) -> list[Solid]:
    """Return boxes round the corner, lower than the camera, with room behind."""
    middle = length - 0.62 + rng.uniform(-0.03, 0.03)
    front = depth - 1.25
    return [
        box("carton", (length - 1.2, front), (middle - 0.01, front + 0.4), rng.uniform(0.55, 0.75)),
        box("carton", (length - 1.2, front + 0.41), (length - 0.85, depth - 0.3), 0.7),
        box("carton", (middle + 0.01, front - 0.05), (length - 0.03, front + 0.4), rng.uniform(0.7, 0.95)),
    ]


def _routes(lanes: tuple[float, float, float, float], door: float) -> dict[str, Array]:
    west, east, south, north = lanes
    cut = 0.95
    lap = [(east, south), (east, north), (west + cut, north), (west, north - cut), (west, south)]
    start = (west + 0.3, south)
    out = [(door, south), (door, -1.45), (1.5, -1.45), (-3.2, -1.45)]
    once = rounded([start, *lap, *out], radius=0.5)
    twice = rounded([start, *lap, *lap, *out], radius=0.5)
    return {"tour": once, "operator": twice}


def _operator(route: Array, door: float) -> OperatorPlan:
    """Return a slow drive that looks at the desks in the middle on the first lap, and waits for the open door."""
    lap = (_room_length(route, door) - 2.0) / 2.0
    looks = [(share * lap, 1.1) for share in (0.02, 0.27, 0.45, 0.62, 0.8)]
    waits = ((_room_length(route, door) - 2.2, LEAVES_AT + 14.0),)
    return OperatorPlan(route="operator", speed=0.21, waits=waits, looks=tuple(looks))


def _room_length(route: Array, door: float) -> float:
    """Return the way along `route` to the door [m]."""
    inside = np.flatnonzero((np.abs(route[:, 0] - door) < 0.2) & (route[:, 1] < 0.0))
    return float(arc_lengths(route)[inside[0]])


def _errands(rng: np.random.Generator, standing: tuple[Array, Array], opener: Array, door: float) -> tuple[Errand, ...]:
    """Return two who stand, one who opens the door and walks out, one who walks in the passage and then stops."""
    still = [
        Errand(name=f"d{number}", places=((float(x), float(y), 0.0),), face=float(rng.uniform(-np.pi, np.pi)))
        for number, (x, y) in enumerate(standing, start=1)
    ]
    south, pace = -_WALL - _PASSAGE + 0.45, float(rng.uniform(0.8, 1.0))
    stop = float(rng.uniform(0.8, 1.6))
    opens = Errand(
        name="e",
        places=(
            (float(opener[0]), float(opener[1]), LEAVES_AT),
            (door, 0.75, 0.5),
            (door, -1.2, 0.0),
            (4.3 + float(rng.uniform(-0.3, 0.3)), south, 0.0),
        ),
        pace=pace,
        face=float(rng.uniform(2.0, 4.0)),
    )
    turns = [(3.0, south, 1.0), (-2.5, south, 1.0)]
    laps = round(STOPS_AT / (2.0 * (5.5 / pace + 2.0)))
    walks = Errand(name="g", places=(*turns * laps, (stop, south, 0.0)), pace=pace, face=float(rng.uniform(-2.0, 2.0)))
    return (*still, opens, walks)


def _floor(length: float, depth: float, door: float) -> Array:
    left, right, south = door - _DOOR / 2.0, door + _DOOR / 2.0, -_WALL - _PASSAGE
    inside = [(left, 0.0), (0.0, 0.0), (0.0, depth), (length, depth), (length, 0.0), (right, 0.0)]
    return np.array(
        [
            *inside,
            (right, -_WALL),
            (length + 2.0, -_WALL),
            (length + 2.0, south),
            (-4.0, south),
            (-4.0, -_WALL),
            (left, -_WALL),
        ]
    )


def _marks(length: float, depth: float, door: float, errands: tuple[Errand, ...]) -> dict[str, Array]:
    def around(low: tuple[float, float], high: tuple[float, float]) -> Array:
        return np.array([low, (high[0], low[1]), high, (low[0], high[1])])

    def about(place: tuple[float, float, float], half: float = 0.45) -> Array:
        return around((place[0] - half, place[1] - half), (place[0] + half, place[1] + half))

    d1, d2, e, g = errands
    return {
        "a": around((0.0, depth - 1.53), (1.48, depth)),
        "b": around((length - 0.84, depth - 0.84), (length, depth)),
        "c": around((door - _DOOR / 2.0, -_WALL - 0.05), (door + _DOOR / 2.0, 0.05)),
        "d1": about(d1.places[0]),
        "d2": about(d2.places[0]),
        "e": about(e.places[0]),
        "f": about(e.places[-1]),
        "g": about(g.places[-1]),
    }


def _standing_places(solids: list[Solid], route: Array) -> Array:
    """Return (m, 2) places beside the route that are clear of furniture and of all of the route."""
    points = resample(route, 0.1)[: -int(RUN_OUT / 0.1)]
    ahead = tangents(points)
    found = []
    for lateral in (-1.0, -0.8, 0.8, 1.0):
        spots = points + lateral * np.stack((-ahead[:, 1], ahead[:, 0]), axis=-1)
        clear = np.min([solid.distance(spots) for solid in solids if solid.blocks_people], axis=0) > 0.28
        from_lane = np.hypot(*(spots[:, None] - points[None]).transpose(2, 0, 1)).min(axis=1)
        room = clear & (from_lane > abs(lateral) - 0.01)
        found.append(np.stack((np.arange(len(points)) * 0.1, np.full(len(points), lateral)), axis=-1)[room])
    return np.concatenate(found)
