"""Offices: rooms along corridors, doors, furniture, and tours through several rooms."""

import numpy as np

from ...slam.errors import InputError
from .cells import merged_boxes, walls_around
from .office_furniture import furniture
from .office_layout import CELL, TESTING, TRAINING, WALL
from .request import SceneRequest
from .scene import Scene
from .tours import PERSON_CLEARANCE, ROBOT_CLEARANCE, FloorPlan, draw_tour, toured
from .ways import WayPlanner

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
    testing = request.split == "test"
    kinds = TESTING if testing else TRAINING
    for _ in range(_ATTEMPTS):
        drawn = np.random.default_rng(2 * int(rng.integers(_BUILDINGS)) + int(testing))
        layout = kinds[int(drawn.integers(len(kinds)))](drawn)
        things, floor = tuple(furniture(drawn, layout)), layout.painted()
        space = floor.without(things)
        planner = WayPlanner(space, ROBOT_CLEARANCE)
        rooms = np.array([part.middle for part in (*layout.rooms, *layout.rooms, *layout.doors)])
        tour = draw_tour(planner, rng, rooms)
        if tour is not None:
            walls = merged_boxes(walls_around(floor.free, round(WALL / CELL)), CELL, floor.origin)
            width = min(min(part.x1 - part.x0, part.y1 - part.y0) for part in layout.corridors)
            plan = FloorPlan(name="office", solids=(*walls, *things), space=space, half_width=width / 2.0 - 0.2)
            return toured(plan, tour, rng, request.route, WALKS, WayPlanner(space, PERSON_CLEARANCE))
    raise InputError(f"no office with room for a tour in {_ATTEMPTS} draws")
