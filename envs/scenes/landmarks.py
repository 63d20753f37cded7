"""Open ground with round posts at random places: a world for landmark SLAM (Urvina et al. 2023, Figure 5)."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from .polyline import arc_lengths, resample, tangents
from .scene import RUN_OUT, OperatorPlan, Scene, choose_route
from .solids import Solid, post

Array = NDArray[np.float64]

RADIUS = 0.1
"""Radius of the posts [m]."""
SIZE = 7.0
"""Mean distance of the lap from its middle [m], before it is varied by up to a tenth."""
_COUNT = (24, 33)
_MARGIN = 5.0  # posts stand up to so far outside the lap [m]
_OFF_LANE, _APART = 0.75, 1.5
_LAPS = 2


def landmarks(rng: np.random.Generator, route: str | None = None) -> Scene:
    """Return open ground with 24 to 32 posts around a bent lap of about 45 m, which is driven twice.

    Routes: "anticlockwise" and "clockwise".
    """
    lap = _lap(rng)
    routes = {"anticlockwise": _laps(lap), "clockwise": _laps(lap[::-1])}
    name = choose_route(routes, route, rng)
    half = float(np.abs(lap).max()) + _MARGIN
    scene = Scene(
        name="landmarks",
        solids=tuple(_posts(rng, lap, half)),
        floor=np.array([(half, half), (-half, half), (-half, -half), (half, -half)]),
        routes=routes,
        route_name=name,
        lap=float(arc_lengths(lap)[-1]),
        half_width=_OFF_LANE - 2.0 * RADIUS,
        standing_places=np.zeros((0, 2)),
        operator=OperatorPlan(route=name, speed=0.8),
    )
    return replace(scene, standing_places=_standing_places(scene))


def _lap(rng: np.random.Generator) -> Array:
    """Return a closed curve (n, 2) around the origin, its distance from there varied by two waves."""
    angle = np.linspace(0.0, 2.0 * np.pi, 721)
    size, phase = SIZE * rng.uniform(0.9, 1.1), rng.uniform(0.0, 2.0 * np.pi, 2)
    share = rng.uniform(0.0, 1.0, 2) * (0.12, 0.06)
    distance = size * (1.0 + share[0] * np.cos(2.0 * angle + phase[0]) + share[1] * np.cos(3.0 * angle + phase[1]))
    return resample(distance[:, None] * np.stack((np.cos(angle), np.sin(angle)), axis=-1), 0.05)


def _laps(lap: Array) -> Array:
    """Return the lap driven several times, and `RUN_OUT` metres more."""
    gap = float(np.hypot(*(lap[0] - lap[-1])))
    closed = lap if gap < 1e-9 else np.vstack((lap, lap[:1]))
    whole = np.concatenate([closed[:-1]] * (_LAPS + 1))
    arcs = arc_lengths(whole)
    end = _LAPS * float(arc_lengths(closed)[-1]) + RUN_OUT
    last = np.array([np.interp(end, arcs, whole[:, axis]) for axis in (0, 1)])
    return np.vstack((whole[arcs < end - 1e-9], last))


def _posts(rng: np.random.Generator, lap: Array, half: float) -> list[Solid]:
    count, places = int(rng.integers(*_COUNT)), np.zeros((0, 2))
    while len(places) < count:
        place = rng.uniform(-half, half, 2)
        apart = np.hypot(*(places - place).T).min(initial=np.inf)
        if apart >= _APART and np.hypot(*(lap - place).T).min() >= _OFF_LANE:
            places = np.vstack((places, place))
    return [post("post", float(x), float(y), RADIUS, top=1.5) for x, y in places]


def _standing_places(scene: Scene) -> Array:
    """Return places beside the first lap that are clear of posts and of the robot's lane."""
    points = resample(scene.route, 0.1)[: int(scene.lap / 0.1)]
    ahead = tangents(points)
    found = []
    for lateral in (-0.9, 0.9):
        spots = points + lateral * np.stack((-ahead[:, 1], ahead[:, 0]), axis=-1)
        arcs = np.arange(len(points)) * 0.1
        room = (scene.clearance(spots, of_people=True) > 0.3) & (arcs > 5.0)
        found.append(np.stack((arcs[room], np.full(int(room.sum()), lateral)), axis=-1))
    return np.concatenate(found)
