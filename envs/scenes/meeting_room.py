"""A meeting room: a big table with chairs in the middle, cabinets along the walls."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from .polyline import arc_lengths, resample, rounded, tangents
from .scene import RUN_OUT, Scene, choose_route
from .solids import Solid, box, post

Array = NDArray[np.float64]

LENGTH, WIDTH = 10.0, 7.0
"""Sides of the room [m], before they are varied by up to a quarter."""
_WALL = 0.3
_CABINET = 0.42
_CHAIR = 0.38
_LAPS = 2


def meeting_room(rng: np.random.Generator, route: str | None = None) -> Scene:
    """Return a room of about 10 x 7 m, driven in two laps around its table.

    Routes: "anticlockwise" and "clockwise".
    """
    half_x, half_y = np.array([LENGTH, WIDTH]) * rng.uniform(0.75, 1.25, 2) / 2.0
    table_x = float(np.clip(half_x - rng.uniform(2.15, 2.6), 1.0, 3.0))
    table_y = float(np.clip(half_y - rng.uniform(2.15, 2.6), 0.45, 1.0))
    solids = [
        *_walls(rng, half_x, half_y),
        *_table(rng, table_x, table_y),
        *_chairs(rng, table_x, table_y),
        *_cabinets(rng, half_x, half_y),
    ]
    lane_x = ((table_x + _CHAIR) + (half_x - _CABINET)) / 2.0
    lane_y = ((table_y + _CHAIR) + (half_y - _CABINET)) / 2.0
    lap = _lap(lane_x, lane_y)
    routes = {"anticlockwise": _laps(lap), "clockwise": _laps(lap[::-1])}
    name = choose_route(routes, route, rng)
    drawn = Scene(
        name="meeting_room",
        solids=tuple(solids),
        floor=np.array([[half_x, half_y], [-half_x, half_y], [-half_x, -half_y], [half_x, -half_y]]),
        routes=routes,
        route_name=name,
        lap=float(arc_lengths(lap)[-1]),
        half_width=min(half_x - _CABINET - lane_x, half_y - _CABINET - lane_y),
        standing_places=np.zeros((0, 2)),
    )
    return replace(drawn, standing_places=_standing_places(drawn))


def _lap(lane_x: float, lane_y: float) -> Array:
    corners = [(0.0, -lane_y), (lane_x, -lane_y), (lane_x, lane_y), (-lane_x, lane_y), (-lane_x, -lane_y)]
    return rounded([*corners, (0.0, -lane_y)], radius=0.9)


def _laps(lap: Array) -> Array:
    """Return the lap driven several times, and `RUN_OUT` metres more."""
    run_out = arc_lengths(lap) <= RUN_OUT
    last = lap[: int(run_out.sum())]
    beyond = lap[int(run_out.sum())]
    step = beyond - last[-1]
    end = last[-1] + step / np.hypot(*step) * (RUN_OUT - arc_lengths(lap)[len(last) - 1])
    return np.concatenate([*[lap[:-1]] * _LAPS, last, end[None]])


def _walls(rng: np.random.Generator, half_x: float, half_y: float) -> list[Solid]:
    door = rng.uniform(-0.5, 0.5) * half_x
    width, depth = rng.uniform(0.45, 0.6), rng.uniform(0.1, 0.28)
    return [
        box("wall", (-half_x - _WALL, half_y), (half_x + _WALL, half_y + _WALL)),
        box("wall", (-half_x - _WALL, -half_y - _WALL), (-half_x, half_y)),
        box("wall", (half_x, -half_y - _WALL), (half_x + _WALL, half_y)),
        box("wall", (-half_x, -half_y - _WALL), (door - width, -half_y)),
        box("wall", (door + width, -half_y - _WALL), (half_x, -half_y)),
        box("door", (door - width, -half_y - depth - _WALL), (door + width, -half_y - depth)),
    ]


def _table(rng: np.random.Generator, table_x: float, table_y: float) -> list[Solid]:
    top = box("table", (-table_x, -table_y), (table_x, table_y), top=0.75, bottom=0.7)
    inset, radius = rng.uniform(0.08, 0.25), rng.uniform(0.025, 0.05)
    across = (-table_y + inset, table_y - inset)
    along = np.linspace(-table_x + inset, table_x - inset, 2 if table_x < 1.6 else 3)
    legs = [post("table leg", float(x), y, radius, 0.7, blocks_people=False) for x in along for y in across]
    return [top, *legs]


def _chairs(rng: np.random.Generator, table_x: float, table_y: float) -> list[Solid]:
    """Return chairs along the long sides and at the ends, all with four legs or all on one post."""
    four_legged = bool(rng.random() < 0.5)
    seats = max(2, int(2.0 * table_x / 0.75))
    places = [(x, side * table_y, side * np.pi / 2.0) for x in _spread(table_x, seats) for side in (-1.0, 1.0)]
    places += [(side * table_x, 0.0, 0.0 if side > 0.0 else np.pi) for side in (-1.0, 1.0)]
    solids: list[Solid] = []
    for x, y, outward in places:
        present, out, yaw = rng.random() < 0.85, rng.uniform(-0.05, 0.1), outward + rng.uniform(-0.3, 0.3)
        if present:
            solids += _chair(x + out * np.cos(outward), y + out * np.sin(outward), yaw, four_legged)
    return solids


def _spread(half: float, count: int) -> Array:
    return (np.arange(count) + 0.5) / count * 2.0 * half - half


def _chair(x: float, y: float, yaw: float, four_legged: bool) -> list[Solid]:
    seat = Solid(kind="chair", x=x, y=y, yaw=yaw, half_length=0.21, half_width=0.21, bottom=0.42, top=0.48)
    if not four_legged:
        return [seat, post("chair leg", x, y, 0.035, 0.42, blocks_people=False)]
    cos, sin = np.cos(yaw), np.sin(yaw)
    legs = [
        post("chair leg", x + cos * u - sin * v, y + sin * u + cos * v, 0.016, 0.42, blocks_people=False)
        for u in (-0.18, 0.18)
        for v in (-0.18, 0.18)
    ]
    return [seat, *legs]


def _cabinets(rng: np.random.Generator, half_x: float, half_y: float) -> list[Solid]:
    """Return cabinets along the walls, away from the corners, where people can stand."""
    solids = []
    for side in (-1.0, 1.0):
        size, depth, top = rng.uniform(0.8, 2.2), rng.uniform(0.3, _CABINET), rng.uniform(0.7, 2.0)
        centre = rng.uniform(-1.0, 1.0) * max(0.0, half_y - 1.3 - size / 2.0)
        wall = side * half_x
        solids.append(box("cabinet", (wall - side * depth, centre - size / 2), (wall, centre + size / 2), top))
    size, depth = rng.uniform(1.2, 2.5), rng.uniform(0.3, _CABINET)
    centre = rng.uniform(-1.0, 1.0) * max(0.0, half_x - 1.5 - size / 2.0)
    solids.append(box("cabinet", (centre - size / 2, half_y - depth), (centre + size / 2, half_y), rng.uniform(0.7, 2)))
    return solids


def _standing_places(scene: Scene) -> Array:
    """Return the places beside the lap that are clear of furniture and of the robot's lane: mostly the corners."""
    points = resample(scene.route, 0.1)[: int(scene.lap / 0.1)]
    directions = tangents(points)
    outward = np.sign(-points[:, 0] * directions[:, 1] + points[:, 1] * directions[:, 0])
    outward = np.where(outward == 0.0, 1.0, -outward)
    found = []
    for distance in (0.75, 0.9, 1.05):
        lateral = -outward * distance
        spots = points + lateral[:, None] * np.stack((-directions[:, 1], directions[:, 0]), axis=-1)
        from_lane = np.hypot(*(spots[:, None] - points[None]).transpose(2, 0, 1)).min(axis=1)
        room = (scene.clearance(spots, of_people=True) > 0.28) & (from_lane > distance - 0.01)
        found.append(np.stack((np.arange(len(points)) * 0.1, lateral), axis=-1)[room])
    return np.concatenate(found[::-1])
