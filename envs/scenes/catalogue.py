"""The table of scenes."""

import numpy as np

from ...slam.errors import unknown_name
from .corridor import corridor
from .floor_plan import floor_plan
from .follow_bench import clutter, doorway, intersection, narrow_corridor
from .hard_cells import busy_crossing, narrow_doors, packed_clutter, tight_doorway, wide_corridor
from .lab import lab
from .landmarks import landmarks
from .meeting_room import meeting_room
from .office import office, tight_office
from .plain_corridor import plain_corridor
from .request import SceneMaker, SceneRequest
from .scene import Scene
from .scene_check import checked_scene

SCENES: dict[str, SceneMaker] = {
    "busy_crossing": busy_crossing,
    "clutter": clutter,
    "corridor": lambda rng, request: corridor(rng, request.route),
    "doorway": doorway,
    "floor_plan": floor_plan,
    "intersection": intersection,
    "lab": lambda rng, request: lab(rng, request.route),
    "landmarks": lambda rng, request: landmarks(rng, request.route),
    "meeting_room": lambda rng, request: meeting_room(rng, request.route),
    "narrow_corridor": narrow_corridor,
    "narrow_doors": narrow_doors,
    "office": office,
    "packed_clutter": packed_clutter,
    "plain_corridor": lambda rng, request: plain_corridor(rng, request.route),
    "tight_doorway": tight_doorway,
    "tight_office": tight_office,
    "wide_corridor": wide_corridor,
}
"""Name -> function of the source of all draws and what is asked for."""


def make_scene(
    scene: str | SceneMaker, rng: np.random.Generator, route: str | None = None, request: SceneRequest | None = None
) -> Scene:
    """Return a building, its sizes and clutter drawn from `rng`.

    Args:
        scene: Its kind, a key of `SCENES`; or a function of one's own that takes `rng` and the request and returns a
            `Scene`.
        rng: Source of all draws.
        route: Name of one of the scene's tours; None draws one. Only without `request`.
        request: All that can be asked for.

    Raises:
        InputError: If the scene or the route is unknown, or a function of one's own returns none that can be used.
    """
    request = request or SceneRequest(route=route)
    check_scene_name(scene)
    if isinstance(scene, str):
        return SCENES[scene](rng, request)
    return checked_scene(scene(rng, request), request)


def check_scene_name(scene: object) -> None:
    """Refuse what is neither a kind of building nor a function.

    Raises:
        InputError: Naming the kinds that there are.
    """
    if not callable(scene) and (not isinstance(scene, str) or scene not in SCENES):
        raise unknown_name("scene", scene, tuple(SCENES))
