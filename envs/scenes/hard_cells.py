"""Buildings in which following is hard: dense, narrow, or both.

Densities and widths after Follow-Bench's matrix (MedlarTea/follow-bench: corridor 5.6 m with 4 to 28 people,
intersection 4.8 m with up to 26, clutter of 10 to 40 obstacles), and doors of 0.9 m, through which a Dingo of 0.52 m
just goes. Buildings and people are ours.
"""

import numpy as np

from .follow_bench import situation
from .office import TIGHT_DOOR
from .office_layout import CELL, WALL, OfficeLayout, Rectangle
from .request import SceneRequest
from .scene import Scene
from .tours import PERSON_CLEARANCE

_OBSTACLES = 30


def wide_corridor(rng: np.random.Generator, request: SceneRequest) -> Scene:
    """Return a corridor of 18 x 5.6 m between two halls; bystanders come along it, both ways."""
    layout = OfficeLayout(
        corridors=(Rectangle(6.0, -2.8, 24.0, 2.8),),
        rooms=(Rectangle(0.0, -4.0, 6.0, 4.0), Rectangle(24.0, -4.0, 30.0, 4.0)),
        doors=(),
    )
    ends = (Rectangle(0.8, -3.2, 5.0, 3.2), Rectangle(25.0, -3.2, 29.2, 3.2))
    return situation("wide_corridor", rng, request, layout, (ends,), 2.6)


def narrow_doors(rng: np.random.Generator, request: SceneRequest) -> Scene:
    """Return four rooms of 5.5 x 6 m in a row, with a door of 0.9 m, somewhere, between each and the next."""
    size, half = 5.5, 3.0
    starts = [k * (size + WALL) for k in range(4)]
    rooms = tuple(Rectangle(x, -half, x + size, half) for x in starts)
    doors = tuple(_door(rng, x + size, 1.7) for x in starts[:-1])
    ends = (Rectangle(0.8, -2.2, 3.0, 2.2), Rectangle(starts[-1] + 2.5, -2.2, starts[-1] + 4.7, 2.2))
    near, far = (Rectangle(starts[k] + 1.0, -2.0, starts[k] + 4.5, 2.0) for k in (1, 2))
    layout = OfficeLayout(corridors=(), rooms=rooms, doors=doors)
    return situation("narrow_doors", rng, request, layout, (ends, (near, far), ends), 0.4, clearance=PERSON_CLEARANCE)


def tight_doorway(rng: np.random.Generator, request: SceneRequest) -> Scene:
    """Return two rooms of 9 x 8 m with a door of 0.9 m between them, through which everybody goes."""
    layout = OfficeLayout(
        corridors=(),
        rooms=(Rectangle(0.0, -4.0, 9.0, 4.0), Rectangle(9.0 + WALL, -4.0, 18.0 + WALL, 4.0)),
        doors=(_door(rng, 9.0, 2.0),),
    )
    ends = (Rectangle(0.8, -3.2, 4.0, 3.2), Rectangle(14.2, -3.2, 17.3, 3.2))
    return situation("tight_doorway", rng, request, layout, (ends,), 0.4, clearance=PERSON_CLEARANCE)


def busy_crossing(rng: np.random.Generator, request: SceneRequest) -> Scene:
    """Return two corridors of 24 and 18 x 4.8 m that cross; bystanders go along the other one."""
    along, across = Rectangle(-12.0, -2.4, 12.0, 2.4), Rectangle(-2.4, -9.0, 2.4, 9.0)
    layout = OfficeLayout(corridors=(along, across), rooms=(), doors=())
    ends = (Rectangle(-11.2, -1.4, -10.0, 1.4), Rectangle(10.0, -1.4, 11.2, 1.4))
    crossing = (Rectangle(-1.9, -8.4, 1.9, -5.0), Rectangle(-1.9, 5.0, 1.9, 8.4))
    return situation("busy_crossing", rng, request, layout, (ends, crossing, crossing, crossing), 2.2)


def packed_clutter(rng: np.random.Generator, request: SceneRequest) -> Scene:
    """Return a hall of 20 x 11 m with up to 30 boxes and posts standing about; bystanders go anywhere."""
    layout = OfficeLayout(corridors=(), rooms=(Rectangle(0.0, -5.5, 20.0, 5.5),), doors=())
    ends = (Rectangle(0.8, -4.5, 2.5, 4.5), Rectangle(17.5, -4.5, 19.2, 4.5))
    sides = (Rectangle(2.0, -5.0, 18.0, -2.0), Rectangle(2.0, 2.0, 18.0, 5.0))
    return situation("packed_clutter", rng, request, layout, (ends, sides, ends), 0.8, obstacles=_OBSTACLES)


def _door(rng: np.random.Generator, wall: float, half: float) -> Rectangle:
    """Return a door in the wall that begins at x = `wall`, with its lower edge within `half` of the middle [m]."""
    at = round(float(rng.uniform(-half, half - TIGHT_DOOR)) / CELL) * CELL
    return Rectangle(wall, at, wall + WALL, at + TIGHT_DOOR)
