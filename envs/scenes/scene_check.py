"""Whether a scene of one's own can be used: whatever would go wrong later is said at once, in one line."""

import numpy as np

from ...slam.errors import InputError, shown, unknown_name
from ..limits.field_checks import finite_numbers
from .request import SceneRequest
from .scene import RUN_OUT, Door, Errand, Scene, Walk
from .solids import Solid

SHORTEST_TOUR = 2.0
"""Shortest way from a route's beginning to where the leader stops [m]: the leader starts 1.5 m before the robot."""
LARGEST = 500.0
"""Largest extent of a building [m]: far beyond the reach of any laser here, and of what a map can hold."""
MOST_SOLIDS = 5000
ROOM = 0.3
"""Least distance from a route to what the robot would hit [m]: half the width of the robot."""


def checked_scene(scene: object, request: SceneRequest) -> Scene:
    """Return `scene`, which a function of one's own has made for `request`.

    Raises:
        InputError: Naming the scene, what must be so, and what was got.
    """
    if not isinstance(scene, Scene):
        raise InputError(f"a scene's function must return a Scene, got {shown(scene)}")
    who = f"scene {shown(scene.name)}"
    _check_solids(who, scene)
    _check_points(f"the `floor` of {who}", scene.floor, 3)
    _check_routes(who, scene, request)
    _check_people(who, scene)
    return scene


def _check_solids(who: str, scene: Scene) -> None:
    solids = scene.solids
    if not isinstance(solids, tuple) or not 1 <= len(solids) <= MOST_SOLIDS:
        raise InputError(f"the `solids` of {who} must be a tuple of 1 to {MOST_SOLIDS} Solid, got {shown(solids)}")
    for solid in solids:
        if not isinstance(solid, Solid) or not _has_a_body(solid):
            raise InputError(f"the `solids` of {who} must be finite, and none of them flat, got {shown(solid)}")
    x0, y0, x1, y1 = scene.bounds
    if max(abs(value) for value in scene.bounds) > LARGEST:
        raise InputError(f"{who} must be within {LARGEST:g} m of its origin, got {(x0, y0, x1, y1)}")


def _has_a_body(solid: Solid) -> bool:
    """Return whether a solid is finite and flat in no direction."""
    finite = finite_numbers([*solid.outline().ravel(), solid.bottom, solid.top]) is not None
    return finite and min(solid.half_length, solid.half_width) + solid.radius > 0.0 and solid.top > solid.bottom


def _check_routes(who: str, scene: Scene, request: SceneRequest) -> None:
    if not isinstance(scene.routes, dict) or not scene.routes:
        raise InputError(f"the `routes` of {who} must be a table of names and points, got {shown(scene.routes)}")
    for name in dict.fromkeys((scene.route_name, request.route)):
        if name is not None and name not in scene.routes:
            raise unknown_name("route", name, tuple(scene.routes))
    what = f"route {shown(scene.route_name)} of {who}"
    _check_points(what, scene.route, 2)
    if scene.tour_length < SHORTEST_TOUR:
        long = f"{RUN_OUT + SHORTEST_TOUR:g} m long, the last {RUN_OUT:g} m behind the tour's end"
        raise InputError(f"{what} must be at least {long}, got {scene.tour_length + RUN_OUT:.2f} m")
    room = scene.clearance(scene.route)
    if room.min() < ROOM:
        x, y = scene.route[int(room.argmin())].tolist()
        raise InputError(f"{what} must keep {ROOM} m from everything, got {room.min():.2f} m at ({x:.2f}, {y:.2f})")
    if not 0.0 < scene.half_width <= LARGEST or not 0.0 <= scene.lap <= scene.tour_length:
        given = f"{shown(scene.half_width)} and {shown(scene.lap)}"
        raise InputError(f"{who} must have a positive `half_width` and a `lap` no longer than its tour, got {given}")


def _check_people(who: str, scene: Scene) -> None:
    places = finite_numbers(scene.standing_places)
    if places is None or places.ndim != 2 or places.shape[1] != 2:
        raise InputError(f"the `standing_places` of {who} must be finite, (m, 2), got {shown(scene.standing_places)}")
    for name, kind in (("walks", Walk), ("doors", Door), ("errands", Errand)):
        given = getattr(scene, name)
        if not isinstance(given, tuple) or not all(isinstance(each, kind) for each in given):
            raise InputError(f"the `{name}` of {who} must be a tuple of {kind.__name__}, got {shown(given)}")
    for walk in scene.walks:
        _check_points(f"a walk of {who}", walk.points, 2)


def _check_points(what: str, points: object, least: int) -> None:
    """Refuse what is no line of at least `least` finite points."""
    found = finite_numbers(points)  # pyright: ignore[reportArgumentType]
    if not isinstance(points, np.ndarray) or found is None or found.ndim != 2 or found.shape[1] != 2:
        raise InputError(f"{what} must be an array (k, 2) of finite numbers, got {shown(points)}")
    if len(found) < least or np.ptp(found, axis=0).max() == 0.0:
        raise InputError(f"{what} must have at least {least} points, not all the same, got {shown(points)}")
