"""A tour for the leader and walks for the others, planned through any floor."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .cells import FreeSpace
from .polyline import tangents
from .scene import RUN_OUT, Scene, Walk, choose_route
from .solids import Solid
from .way_kernel import apart
from .ways import STEP, Way, WayPlanner, folds

Array = NDArray[np.float64]

ROBOT_CLEARANCE = 0.52
"""Least distance of a tour from the next cell that is not free [m]: the robot's enclosing circle and a hand's width."""
PERSON_CLEARANCE = 0.38
"""The same for the walks of bystanders [m]."""
_SHORTEST, _LONGEST = 14.0, 65.0
_ATTEMPTS = 40
_ENDS = 6
_GOALS = 2


@dataclass(frozen=True, kw_only=True)
class FloorPlan:
    """A floor with what stands on it, before anybody walks there.

    Attributes:
        name: Of the scene.
        solids: Walls and furniture.
        space: Where nothing stands.
        half_width: Typical clear space to both sides of a tour [m].
    """

    name: str
    solids: tuple[Solid, ...]
    space: FreeSpace
    half_width: float


def toured(
    plan: FloorPlan,
    tour: Way,
    rng: np.random.Generator,
    route: str | None,
    walks: int | tuple[Walk, ...],
    planner: WayPlanner,
) -> Scene:
    """Return the scene of `plan` with `tour` and walks of bystanders.

    Args:
        plan: The floor.
        tour: The leader's way.
        rng: Source of all draws.
        route: "tour", or "back": the same the other way; None draws one.
        walks: Ways of bystanders, or how many to draw.
        planner: Plans them, with `PERSON_CLEARANCE`.

    Raises:
        InputError: If there is no such route.
    """
    routes = {"tour": tour.points, "back": tour.points[::-1].copy()}
    name = choose_route(routes, route, rng)
    rows, cols = plan.space.free.shape
    (x0, y0), side = plan.space.origin, plan.space.resolution
    x1, y1 = x0 + cols * side, y0 + rows * side
    return Scene(
        name=plan.name,
        solids=plan.solids,
        floor=np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)]),
        routes=routes,
        route_name=name,
        lap=0.0,
        half_width=plan.half_width,
        standing_places=_beside(routes[name], plan.space),
        walks=tuple(_walks(planner, rng, walks)) if isinstance(walks, int) else walks,
    )


def draw_tour(planner: WayPlanner, rng: np.random.Generator, via: Array | None = None) -> Way | None:
    """Return a way of `_SHORTEST` to `_LONGEST` metres that never turns on the spot; of those tried, the longest.

    Args:
        planner: Plans ways with `ROBOT_CLEARANCE`.
        rng: Source of all draws.
        via: (k, 2) places that a tour likes to pass [m], up to three of them; None takes any.

    Returns:
        The way; None where none was found.
    """
    best: Way | None = None
    wanted = rng.uniform(0.35, 0.7) * _LONGEST
    if len(planner.places) == 0:
        return None
    via = planner.places if via is None else via
    ends = planner.places[rng.integers(len(planner.places), size=_ENDS)]
    for _ in range(_ATTEMPTS):
        start, goal = ends[rng.permutation(_ENDS)[:2]]
        between = via[rng.permutation(len(via))[: int(rng.integers(0, 4))]]
        stops = [planner.nearest(place) for place in between]
        way = planner.way(np.array([start, *(s for s in stops if s is not None), goal]))
        if way is None or way.length > _LONGEST or folds(way.points):
            continue
        if best is None or way.length > best.length:
            best = way
        if best.length > wanted:
            break
    return best if best is not None and best.length >= _SHORTEST + RUN_OUT else None


def _walks(planner: WayPlanner, rng: np.random.Generator, count: int) -> list[Walk]:
    """Return up to `count` ways of 5 to 30 m between drawn places."""
    walks: list[Walk] = []
    for _ in range(count):
        start = planner.places[rng.integers(len(planner.places))]
        price = planner.distances(start, within=35.0)
        goals = planner.places[(price > 5.0) & (price < 35.0)]
        for goal in goals[rng.integers(len(goals), size=_GOALS)] if len(goals) else ():
            way = planner.way(np.array([start, goal]))
            if way is not None and 5.0 <= way.length <= 30.0 and len(walks) < count:
                walks.append(Walk(points=way.points))
    return walks


def _beside(points: Array, space: FreeSpace) -> Array:
    """Return (m, 2) arc length and lateral offset of places beside a way where a person can stand, off its lane."""
    ahead = tangents(points)
    left = np.stack((-ahead[:, 1], ahead[:, 0]), axis=-1)
    arcs = np.arange(len(points)) * STEP
    inner = (arcs > 5.0) & (arcs < arcs[-1] - 6.0)
    found = []
    for lateral in (-1.0, -0.85, 0.85, 1.0):
        spots = points + lateral * left
        room = inner & (space.clearance_at(spots) > 0.34) & (apart(spots, points) > abs(lateral) - 0.02)
        found.append(np.stack((arcs[room], np.full(int(room.sum()), lateral)), axis=-1))
    return np.concatenate(found)
