"""The table of scenes."""

from collections.abc import Callable

import numpy as np

from ...slam.errors import unknown_name
from .corridor import corridor
from .lab import lab
from .meeting_room import meeting_room
from .plain_corridor import plain_corridor
from .scene import Scene

SCENES: dict[str, Callable[[np.random.Generator, str | None], Scene]] = {
    "corridor": corridor,
    "lab": lab,
    "meeting_room": meeting_room,
    "plain_corridor": plain_corridor,
}
"""Name -> function of (rng, route name or None)."""


def make_scene(name: str, rng: np.random.Generator, route: str | None = None) -> Scene:
    """Return a building of the kind `name`, its sizes and clutter drawn from `rng`.

    Args:
        name: A key of `SCENES`.
        rng: Source of all draws.
        route: Name of one of the scene's tours; None draws one.

    Raises:
        InputError: If the scene or the route is unknown.
    """
    if name not in SCENES:
        raise unknown_name("scene", name, tuple(SCENES))
    return SCENES[name](rng, route)
