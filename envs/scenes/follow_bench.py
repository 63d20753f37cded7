"""The four situations of Follow-Bench: a corridor, a doorway, an intersection, and clutter.

After the benchmark of the same name for robots that follow a person (MedlarTea/follow-bench): what people do there
(meet head on, squeeze through a door, cross) is what its scenarios are named by. Sizes and people are ours, in 3-D,
with legs that a laser can see.
"""

import numpy as np
from numpy.typing import NDArray

from .cells import merged_boxes, walls_around
from .office_layout import CELL, WALL, OfficeLayout, Rectangle
from .request import NoRoomError, SceneRequest
from .scene import Scene, Walk
from .solids import Solid, box, post
from .tours import PERSON_CLEARANCE, ROBOT_CLEARANCE, FloorPlan, toured
from .ways import WayPlanner

Array = NDArray[np.float64]

WALKS = 12
"""Ways of bystanders in each of them."""
_ATTEMPTS = 30
_OBSTACLES = 20


def narrow_corridor(rng: np.random.Generator, request: SceneRequest) -> Scene:
    """Return a corridor of 18 x 1.9 to 2.4 m between two halls; bystanders come along it, both ways."""
    width = round(float(rng.uniform(1.9, 2.4)) / CELL) * CELL
    half = width / 2.0
    layout = OfficeLayout(
        corridors=(Rectangle(6.0, -half, 24.0, half),),
        rooms=(Rectangle(0.0, -3.0, 6.0, 3.0), Rectangle(24.0, -3.0, 30.0, 3.0)),
        doors=(),
    )
    ends = (Rectangle(0.8, -2.2, 5.0, 2.2), Rectangle(25.0, -2.2, 29.2, 2.2))
    return situation("narrow_corridor", rng, request, layout, (ends,), half - 0.2)


def doorway(rng: np.random.Generator, request: SceneRequest) -> Scene:
    """Return two rooms of 9 x 8 m with a door of 1.15 to 1.4 m between them, through which everybody goes."""
    width = round(float(rng.uniform(1.15, 1.4)) / CELL) * CELL
    at = round(float(rng.uniform(-2.0, 1.0)) / CELL) * CELL
    layout = OfficeLayout(
        corridors=(),
        rooms=(Rectangle(0.0, -4.0, 9.0, 4.0), Rectangle(9.0 + WALL, -4.0, 18.0 + WALL, 4.0)),
        doors=(Rectangle(9.0, at, 9.0 + WALL, at + width),),
    )
    ends = (Rectangle(0.8, -3.2, 4.0, 3.2), Rectangle(14.2, -3.2, 17.3, 3.2))
    return situation("doorway", rng, request, layout, (ends,), 0.8)


def intersection(rng: np.random.Generator, request: SceneRequest) -> Scene:
    """Return two corridors of 24 and 16 x 2.4 to 3 m that cross; bystanders go along the other one."""
    width = round(float(rng.uniform(2.4, 3.0)) / CELL) * CELL
    half = width / 2.0
    along, across = Rectangle(-12.0, -half, 12.0, half), Rectangle(-half, -8.0, half, 8.0)
    layout = OfficeLayout(corridors=(along, across), rooms=(), doors=())
    ends = (Rectangle(-11.2, -0.2, -10.0, 0.2), Rectangle(10.0, -0.2, 11.2, 0.2))
    crossing = (Rectangle(-half + 0.5, -7.4, half - 0.5, -4.0), Rectangle(-half + 0.5, 4.0, half - 0.5, 7.4))
    return situation("intersection", rng, request, layout, (ends, crossing, crossing), half - 0.2)


def clutter(rng: np.random.Generator, request: SceneRequest) -> Scene:
    """Return a hall of 20 x 11 m with up to 20 boxes and posts standing about; bystanders go anywhere."""
    layout = OfficeLayout(corridors=(), rooms=(Rectangle(0.0, -5.5, 20.0, 5.5),), doors=())
    ends = (Rectangle(0.8, -4.5, 2.5, 4.5), Rectangle(17.5, -4.5, 19.2, 4.5))
    sides = (Rectangle(2.0, -5.0, 18.0, -2.0), Rectangle(2.0, 2.0, 18.0, 5.0))
    return situation("clutter", rng, request, layout, (ends, sides, ends), 0.8, obstacles=_OBSTACLES)


def situation(
    name: str,
    rng: np.random.Generator,
    request: SceneRequest,
    layout: OfficeLayout,
    ends: tuple[tuple[Rectangle, Rectangle], ...],
    half_width: float,
    obstacles: int = 0,
    clearance: float = ROBOT_CLEARANCE,
) -> Scene:
    """Return the scene whose tour and whose bystanders' ways lead from one rectangle to another.

    Args:
        name: Of the scene.
        rng: Source of all draws.
        request: What was asked.
        layout: The floor.
        ends: Where ways begin and end: the first pair is the tour's, bystanders take one pair after the other.
        half_width: Clear space to both sides of the tour [m].
        obstacles: How many things stand about.
        clearance: Least distance of the tour from things [m].

    Raises:
        NoRoomError: If there is no room for a tour.
    """
    floor = layout.painted()
    for _ in range(_ATTEMPTS):
        things = _obstacles(rng, layout.rooms[0], obstacles) if obstacles else ()
        space = floor.without(things)
        planner = WayPlanner(space, clearance)
        tour = planner.way([_drawn(rng, end) for end in ends[0]])
        if tour is None:
            continue
        walls = merged_boxes(walls_around(floor.free, round(WALL / CELL)), CELL, floor.origin)
        plan = FloorPlan(name=name, solids=(*walls, *things), space=space, half_width=half_width)
        walking = WayPlanner(space, PERSON_CLEARANCE)
        walks = _walks(rng, walking, ends)
        if len(walks) >= WALKS // 2:
            return toured(plan, tour, rng, request.route, walks, walking)
    raise NoRoomError(f"no {name} with room for a tour in {_ATTEMPTS} draws")


def _walks(
    rng: np.random.Generator, planner: WayPlanner, ends: tuple[tuple[Rectangle, Rectangle], ...]
) -> tuple[Walk, ...]:
    drawn = [planner.way([_drawn(rng, end) for end in ends[k % len(ends)]]) for k in range(WALKS)]
    return tuple(Walk(points=way.points) for way in drawn if way is not None)


def _drawn(rng: np.random.Generator, part: Rectangle) -> tuple[float, float]:
    return float(rng.uniform(part.x0, part.x1)), float(rng.uniform(part.y0, part.y1))


def _obstacles(rng: np.random.Generator, floor: Rectangle, count: int) -> tuple[Solid, ...]:
    """Return boxes and posts away from the two short sides, at least 1.25 m apart."""
    solids: list[Solid] = []
    for _ in range(10 * count):
        x, y = rng.uniform(floor.x0 + 3.2, floor.x1 - 3.2), rng.uniform(floor.y0 + 0.4, floor.y1 - 0.4)
        size = rng.uniform(0.2, 0.5)
        if rng.random() < 0.5:
            solid = box("cabinet", (x - size, y - size), (x + size, y + size), rng.uniform(0.6, 1.8))
        else:
            solid = post("plant", float(x), float(y), float(size), rng.uniform(0.6, 1.8))
        if len(solids) < count and all(other.distance((x, y)) > 1.25 + 1.42 * size for other in solids):
            solids.append(solid)
    return tuple(solids)
