"""A long corridor with an L bend, door recesses, pillars and a platform in a bay."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from .polyline import resample, rounded, tangents
from .scene import Scene, choose_route
from .solids import Solid, box, post

Array = NDArray[np.float64]

LENGTH, BEND, WIDTH = 40.0, 10.0, 2.4
"""Length of the first leg, of the second one, and width [m], before they are varied by up to a quarter."""
_WALL = 0.3
_LANE = 0.72


@dataclass(frozen=True)
class _Wall:
    """A wall's inner face: from `start`, `length` metres along `ahead`; `outward` points away from the corridor."""

    start: tuple[float, float]
    ahead: tuple[float, float]
    outward: tuple[float, float]
    length: float

    def at(self, along: float, out: float) -> tuple[float, float]:
        return (
            self.start[0] + along * self.ahead[0] + out * self.outward[0],
            self.start[1] + along * self.ahead[1] + out * self.outward[1],
        )

    def piece(self, kind: str, along: tuple[float, float], out: tuple[float, float], top: float = 2.5) -> Solid:
        return box(kind, self.at(along[0], out[0]), self.at(along[1], out[1]), top)


def corridor(rng: np.random.Generator, route: str | None = None) -> Scene:
    """Return a corridor of about 40 x 2.4 m that bends into a second leg of about 10 m.

    Routes: "forward" (long leg first) and "back".
    """
    length, bend, width = np.array([LENGTH, BEND, WIDTH]) * rng.uniform(0.75, 1.25, 3)
    turn = float(rng.choice([-1.0, 1.0]))
    half = width / 2.0
    outer = _Wall((0.0, -half * turn), (1.0, 0.0), (0.0, -turn), length)
    inner = _Wall((0.0, half * turn), (1.0, 0.0), (0.0, turn), length - width)
    far = _Wall((length, -half * turn), (0.0, turn), (1.0, 0.0), bend + width)
    near = _Wall((length - width, half * turn), (0.0, turn), (-1.0, 0.0), bend)
    bay = (rng.uniform(0.35, 0.6) * length, rng.uniform(4.0, 6.0), rng.uniform(2.0, 3.0))
    solids = [
        box("wall", (-_WALL, -half), (0.0, half)),
        far.piece("wall", (bend + width, bend + width + _WALL), (-width, 0.0)),
        *_platform(rng, outer, bay),
    ]
    for wall, hole in ((outer, bay), (inner, None), (far, None), (near, None)):
        features = _features(rng, wall, hole)
        solids += _built(wall, features)
        solids += _clutter(rng, wall, features, deepest=half - _LANE)
    routes = _routes(length, bend, width, turn)
    name = choose_route(routes, route, rng)
    floor = [outer.start, outer.at(length, 0.0), far.at(bend + width, 0.0), near.at(bend, 0.0), near.start, inner.start]
    drawn = Scene(
        name="corridor",
        solids=tuple(solids),
        floor=np.array(floor),
        routes=routes,
        route_name=name,
        lap=0.0,
        half_width=half - 0.2,
        standing_places=np.zeros((0, 2)),
    )
    return with_standing_places(drawn, half, rng)


def _routes(length: float, bend: float, width: float, turn: float) -> dict[str, Array]:
    corner = (length - width / 2.0, 0.0)
    end = (length - width / 2.0, turn * (width / 2.0 + bend - 0.8))
    forward = rounded([(1.2, 0.0), corner, end], radius=0.7)
    return {"forward": forward, "back": forward[::-1].copy()}


def _features(
    rng: np.random.Generator, wall: _Wall, bay: tuple[float, float, float] | None
) -> list[tuple[float, float, float]]:
    """Return (from, to, depth) along the wall: doors lie deeper than the wall (depth > 0), pillars stand out (< 0)."""
    found = [] if bay is None else [(bay[0], bay[0] + bay[1], bay[2])]
    along = rng.uniform(1.5, 3.0)
    while along + 2.0 < wall.length:
        if rng.random() < 0.7:
            feature = (along, along + rng.uniform(0.9, 1.3), rng.uniform(0.1, 0.28))
        else:
            feature = (along, along + rng.uniform(0.3, 0.5), -rng.uniform(0.1, 0.18))
        if all(feature[1] + 0.3 < other[0] or feature[0] - 0.3 > other[1] for other in found):
            found.append(feature)
        along += rng.uniform(2.5, 5.5)
    return sorted(found)


def _built(wall: _Wall, features: list[tuple[float, float, float]]) -> list[Solid]:
    solids, reached = [], -_WALL
    for start, end, depth in features:
        solids.append(wall.piece("wall", (reached, start), (0.0, _WALL)))
        kind = "wall" if depth > 0.5 else "door" if depth > 0.0 else "pillar"
        solids.append(wall.piece(kind, (start, end), (depth, max(depth, 0.0) + _WALL)))
        reached = end
    solids.append(wall.piece("wall", (reached, wall.length), (0.0, _WALL)))
    return solids


def _platform(rng: np.random.Generator, wall: _Wall, bay: tuple[float, float, float]) -> list[Solid]:
    start, size, depth = bay
    step = rng.uniform(0.5, 0.9)
    return [
        wall.piece("wall", (start - _WALL, start), (_WALL, depth + _WALL)),
        wall.piece("wall", (start + size, start + size + _WALL), (_WALL, depth + _WALL)),
        wall.piece("platform", (start + 0.4, start + size - 0.4), (step, depth), top=rng.uniform(0.28, 0.4)),
    ]


def _clutter(
    rng: np.random.Generator, wall: _Wall, features: list[tuple[float, float, float]], deepest: float
) -> list[Solid]:
    """Return bins, plants and benches along the wall, away from its features, at most `deepest` metres deep."""
    solids: list[Solid] = []
    along = rng.uniform(4.0, 8.0)
    while along + 3.0 < wall.length and deepest > 0.2:
        size = rng.uniform(0.9, 1.5)
        if all(along + size + 0.2 < start or along - 0.2 > end for start, end, _ in features):
            depth = min(deepest, rng.uniform(0.25, 0.42))
            if rng.random() < 0.5:
                solids.append(wall.piece("bench", (along, along + size), (-depth, 0.0), top=rng.uniform(0.4, 0.5)))
            else:
                x, y = wall.at(along, -depth / 2.0 - 0.02)
                solids.append(post("bin", x, y, depth / 2.0, top=rng.uniform(0.5, 1.1)))
        along += rng.uniform(5.0, 10.0)
    return solids


def with_standing_places(scene: Scene, half: float, rng: np.random.Generator) -> Scene:
    """Return `scene` with the places beside its route where a person fits between the walls and the robot's lane.

    Args:
        scene: A corridor; its route runs along its middle.
        half: Half its width [m].
        rng: Draws the side of each place.
    """
    points = resample(scene.route, 0.1)
    directions = tangents(points)
    arcs = np.arange(len(points)) * 0.1
    side = rng.choice([-1.0, 1.0], len(points))
    lateral = side * (half - 0.34)
    spots = points + lateral[:, None] * np.stack((-directions[:, 1], directions[:, 0]), axis=-1)
    room = (scene.clearance(spots, of_people=True) > 0.3) & (arcs > 5.0) & (arcs < arcs[-1] - 6.0)
    return replace(scene, standing_places=np.stack((arcs, lateral), axis=-1)[room])
