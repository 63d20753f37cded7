"""Offices: rooms along corridors, doors, furniture, and tours through several rooms."""

import math
from dataclasses import replace

import numpy as np

from .cells import merged_boxes, walls_around
from .office_furniture import furniture
from .office_layout import CELL, TESTING, TRAINING, WALL, Rectangle
from .request import NoRoomError, SceneRequest
from .scene import Scene
from .tours import PERSON_CLEARANCE, ROBOT_CLEARANCE, FloorPlan, draw_tour, toured
from .ways import WayPlanner

TIGHT_DOOR = 0.9
"""Width of a usual inner door [m]."""
WALKS = 10
"""Ways that bystanders walk on."""
_BUILDINGS = 2**40
_ATTEMPTS = 20


def office(rng: np.random.Generator, request: SceneRequest) -> Scene:
    """Return an office floor of about 20 x 12 m; `request.split` says of which half.

    Each building is drawn from a number of its own. Training has the even numbers and the kinds of floors `TRAINING`,
    testing the odd ones and `TESTING`, so that neither ever meets a building, or a kind of floor, of the other.
    Routes: "tour" and "back".
    """
    return drawn_office("office", rng, request)


def tight_office(rng: np.random.Generator, request: SceneRequest) -> Scene:
    """Return such an office all of whose doors are `TIGHT_DOOR` wide: a robot of 0.52 m just goes through."""
    return drawn_office("tight_office", rng, request, widest=TIGHT_DOOR, clearance=PERSON_CLEARANCE)


def drawn_office(
    name: str,
    rng: np.random.Generator,
    request: SceneRequest,
    widest: float = math.inf,
    clearance: float = ROBOT_CLEARANCE,
) -> Scene:
    """Return an office floor.

    Args:
        name: Of the scene.
        rng: Source of all draws.
        request: What was asked.
        widest: Doors that are wider than this are made as narrow [m].
        clearance: Least distance of the tour from things [m].

    Raises:
        NoRoomError: If there is no room for a tour.
    """
    testing = request.split == "test"
    kinds = TESTING if testing else TRAINING
    for _ in range(_ATTEMPTS):
        drawn = np.random.default_rng(2 * int(rng.integers(_BUILDINGS)) + int(testing))
        layout = kinds[int(drawn.integers(len(kinds)))](drawn)
        layout = replace(layout, doors=tuple(_narrowed(door, widest) for door in layout.doors))
        things, floor = tuple(furniture(drawn, layout)), layout.painted()
        space = floor.without(things)
        planner = WayPlanner(space, clearance)
        rooms = np.array([part.middle for part in (*layout.rooms, *layout.rooms, *layout.doors)])
        tour = draw_tour(planner, rng, rooms)
        if tour is not None:
            walls = merged_boxes(walls_around(floor.free, round(WALL / CELL)), CELL, floor.origin)
            width = min(min(part.x1 - part.x0, part.y1 - part.y0) for part in layout.corridors)
            plan = FloorPlan(name=name, solids=(*walls, *things), space=space, half_width=width / 2.0 - 0.2)
            return toured(plan, tour, rng, request.route, WALKS, WayPlanner(space, PERSON_CLEARANCE))
    raise NoRoomError(f"no {name} with room for a tour in {_ATTEMPTS} draws")


def _narrowed(door: Rectangle, widest: float) -> Rectangle:
    """Return a door at most `widest` wide, its lower or left end where it was."""
    if door.x1 - door.x0 > door.y1 - door.y0:
        return replace(door, x1=min(door.x1, door.x0 + widest))
    return replace(door, y1=min(door.y1, door.y0 + widest))
