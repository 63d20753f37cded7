"""Who is in the building at the start, and where."""

from dataclasses import replace

import numpy as np

from ...slam.errors import InputError, shown
from ..scenes.request import NoRoomError
from .behaviours.behaviour import Behaviour
from .behaviours.mind import Mind, MindKind
from .body import draw_physique
from .crowd import Casting, Person
from .draft import CastRequest, Draft, Part, people_of
from .movement.bodies import Start
from .movement.ground import Ground
from .movement.obstacles import is_clear
from .movement.terrain import Terrain
from .movement.walking import SPACING
from .route_people import draw_route_people
from .wanderers import draw_wanderers

MOST_ON_ROUTE = 3
"""Most bystanders where their number is drawn and all walk on the leader's way."""
_FROM_ROBOT, _FROM_PEOPLE = 1.5, 0.8  # people of one's own begin no nearer, centre to centre [m]
_ATTEMPTS = 300


def cast_people(request: CastRequest) -> Casting:
    """Draw the people of one episode.

    First come the leader and who keeps the leader company, then those who walk, those who stand beside the route, the
    scripted people of the scene, and people with behaviours of one's own.

    Raises:
        NoRoomError: If the building is too small for so many.
    """
    asked = request if request.with_leader else replace(request, people=request.people + 1)
    drafts, leader = (draw_wanderers if request.scene.walks else draw_route_people)(asked)
    _cast_heedless(asked, drafts)
    people = people_of(drafts, request.terrain, leader if request.with_leader else None)
    minds = [person.behaviour for person in people if isinstance(person.behaviour, Mind)]
    group = sum(mind.kind in (MindKind.LEADER, MindKind.COMPANION) for mind in minds)
    for behaviour in request.behaviours:
        people.append(_own_person(request, behaviour, people))
    return Casting(people=tuple(people), group=group)


def _cast_heedless(request: CastRequest, drafts: list[Draft]) -> None:
    """Decide who of the bystanders does not see the robot: the first of an order that is drawn, as many as asked for.

    The same people in the same places for any share, and more of them for a higher one.
    """
    bystanders = [draft for draft in drafts if draft.part not in (Part.LEADER, Part.COMPANION)]
    order = request.heedless_rng.permutation(len(bystanders))
    for k in order[: round(request.heedless * len(bystanders))]:
        bystanders[k].heedless = True


def _own_person(request: CastRequest, behaviour: Behaviour, people: list[Person]) -> Person:
    physique = draw_physique(request.own_rng)
    if behaviour.start is None:
        start = _drawn_start(request, people)
    else:
        start = _checked_start(behaviour, request.terrain, physique.radius)
    return Person(physique=physique, behaviour=behaviour, start=start, ground=Ground.ELSEWHERE)


def _drawn_start(request: CastRequest, people: list[Person]) -> Start:
    """Return a free place on the route, away from the robot and from people."""
    terrain, rng = request.terrain, request.own_rng
    robot = terrain.place(request.start_arc, 0.0)
    taken = np.array([person.start[:2] for person in people]).reshape(-1, 2)
    for _ in range(_ATTEMPTS):
        arc, sense = float(rng.uniform(0.0, request.scene.tour_length)), float(rng.choice([-1.0, 1.0]))
        offset = terrain.within_free(arc, float(rng.uniform(-1.0, 1.0)) * max(0.0, terrain.passing))
        place = terrain.place(arc, offset)
        apart = np.hypot(*(taken - place).T).min(initial=np.inf) > _FROM_PEOPLE
        if apart and np.hypot(*(robot - place)) > _FROM_ROBOT:
            x, y = place.tolist()
            return Start(x, y, terrain.ahead(arc) + (np.pi if sense < 0.0 else 0.0), arc, sense, offset)
    raise NoRoomError(f"no room for another person in this {request.scene.name}")


def _checked_start(behaviour: Behaviour, terrain: Terrain, radius: float) -> Start:
    """Return where a behaviour says that its person begins.

    Raises:
        InputError: If that is no pose, or somebody cannot stand there.
    """
    name = f"`{type(behaviour).__name__}.start`"
    try:
        x, y, heading = (float(value) for value in behaviour.start or ())
    except (TypeError, ValueError):
        raise InputError(f"{name} must be three numbers (x, y, heading), got {shown(behaviour.start)}") from None
    if not np.isfinite((x, y, heading)).all() or not is_clear(x, y, terrain.boxes, terrain.circles, radius):
        raise InputError(f"{name} must be a place that is {radius:.2f} m from all walls, got {shown(behaviour.start)}")
    route = terrain.ways.points[: terrain.ways.rows[0]]
    arc = float(np.hypot(*(route - (x, y)).T).argmin()) * SPACING
    return Start(x, y, heading, arc)
