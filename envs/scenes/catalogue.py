"""The table of scenes."""

from collections.abc import Callable

import numpy as np

from ...slam.errors import unknown_name
from .corridor import corridor
from .floor_plan import floor_plan
from .follow_bench import clutter, doorway, intersection, narrow_corridor
from .lab import lab
from .landmarks import landmarks
from .meeting_room import meeting_room
from .office import office
from .plain_corridor import plain_corridor
from .request import SceneRequest
from .scene import Scene

SCENES: dict[str, Callable[[np.random.Generator, SceneRequest], Scene]] = {
    "clutter": clutter,
    "corridor": lambda rng, request: corridor(rng, request.route),
    "doorway": doorway,
    "floor_plan": floor_plan,
    "intersection": intersection,
    "lab": lambda rng, request: lab(rng, request.route),
    "landmarks": lambda rng, request: landmarks(rng, request.route),
    "meeting_room": lambda rng, request: meeting_room(rng, request.route),
    "narrow_corridor": narrow_corridor,
    "office": office,
    "plain_corridor": lambda rng, request: plain_corridor(rng, request.route),
}
"""Name -> function of the source of all draws and what is asked for."""


def make_scene(
    name: str, rng: np.random.Generator, route: str | None = None, request: SceneRequest | None = None
) -> Scene:
    """Return a building of the kind `name`, its sizes and clutter drawn from `rng`.

    Args:
        name: A key of `SCENES`.
        rng: Source of all draws.
        route: Name of one of the scene's tours; None draws one. Only without `request`.
        request: All that can be asked for.

    Raises:
        InputError: If the scene or the route is unknown.
    """
    if name not in SCENES:
        raise unknown_name("scene", name, tuple(SCENES))
    return SCENES[name](rng, request or SceneRequest(route=route))
