"""The people of buildings where everybody walks on the robot's route."""

import numpy as np
from numpy.typing import NDArray

from ..scenes.request import NoRoomError
from ..scenes.scene import Errand
from .behaviours.leader import draw_leader
from .behaviours.mind import Mind
from .body import draw_physique
from .draft import CastRequest, Draft, Part, stander_window
from .movement.terrain import Terrain

Array = NDArray[np.float64]

_FROM_ROBOT, _FROM_PEOPLE = 1.2, 0.6  # walkers begin no nearer, centre to centre [m]


def draw_route_people(request: CastRequest) -> tuple[list[Draft], Mind]:
    """Draw a leader, somebody who walks ahead with them, walkers on the route, standers, and the scene's scripted.

    Raises:
        NoRoomError: If the building is too small for so many.
    """
    scene, rng = request.scene, request.rng
    parts = [Part.LEADER, Part.COMPANION][: request.people] + [Part.WALKER] * (request.people - 2)
    parts += [Part.STANDER] * request.standing + [Part.SCRIPTED] * len(scene.errands)
    count = len(parts)
    leader = draw_leader(request.leader_rng, request.style, request.start_arc, scene.tour_length)
    leader_physique = draw_physique(request.leader_rng)
    physiques = [draw_physique(rng) for _ in range(count)]
    physiques[0] = leader_physique
    slow, brisk = rng.uniform(0.5, 0.8, count), rng.uniform(0.7, 1.15, count)
    side, gap = rng.uniform(-0.1, 0.1, count), rng.uniform(1.1, 1.6, count)
    errands = [None] * (count - len(scene.errands)) + list(scene.errands)
    drafts = [
        Draft(
            part=part,
            physique=physiques[k],
            pace=float((slow if part == Part.STANDER else brisk)[k]),
            side=float(side[k]),
            gap=float(gap[k]),
            errand=errands[k],
        )
        for k, part in enumerate(parts)
    ]
    _place(request, drafts, request.start_arc + request.leader_rng.uniform(1.2, 1.5))
    return drafts, leader


def _place(request: CastRequest, drafts: list[Draft], leader_arc: float) -> None:
    """Give everybody but the scripted a place, 1.2 m apart along the route."""
    scene, terrain, rng = request.scene, request.terrain, request.rng
    away = _Away(terrain, request.start_arc, scene.errands)
    for person, draft in enumerate(drafts):
        taken = np.array([other.arc for other in drafts[:person]])
        aside = 0.0
        match draft.part:
            case Part.SCRIPTED:
                continue
            case Part.LEADER:
                draft.arc = leader_arc
            case Part.COMPANION:
                draft.arc = leader_arc + draft.gap
                draft.side *= 10.0 * max(0.0, min(0.3, scene.half_width - 0.5))
            case Part.WALKER:
                low, high = (0.3 * scene.lap, 0.75 * scene.lap) if scene.lap else (6.0, scene.tour_length - 1.0)
                high = min(high + leader_arc, scene.tour_length)
                draft.arc = _apart(low + leader_arc, high, taken, away, rng)
                draft.sense = 1.0 if scene.lap else float(rng.choice([-1.0, 1.0]))
                aside = -draft.sense * (draft.side if scene.lap else terrain.passing)
            case _:
                low, high, draft.side = stander_window(scene, taken, rng)
                draft.arc, draft.window = low + 0.1, (low, high)
        away.take(draft.arc, aside if draft.part == Part.WALKER else draft.side)


class _Away:
    """Who walks on a route that comes by itself again, or by scripted people, must not begin where somebody is."""

    def __init__(self, terrain: Terrain, start_arc: float, errands: tuple[Errand, ...]) -> None:
        self._terrain, self._robot = terrain, terrain.place(start_arc, 0.0)
        self._people = [np.array(errand.places[0][:2]) for errand in errands]

    def take(self, arc: float, lateral: float) -> None:
        """Note that somebody is at `arc` along the route and `lateral` to its left [m], as far as there is room."""
        self._people.append(self._place(arc, lateral))

    def holds(self, arc: float) -> bool:
        """Return whether both sides of the route at `arc` [m] are away from the robot and from people."""
        for side in (-1.0, 1.0):
            place = self._place(arc, side * self._terrain.passing)
            people = np.hypot(*(np.reshape(self._people, (-1, 2)) - place).T).min(initial=np.inf)
            if np.hypot(*(self._robot - place)) < _FROM_ROBOT or people < _FROM_PEOPLE:
                return False
        return True

    def _place(self, arc: float, lateral: float) -> Array:
        return self._terrain.place(arc, self._terrain.within_free(arc, lateral))


def _apart(low: float, high: float, taken: Array, away: _Away, rng: np.random.Generator) -> float:
    for _ in range(200):
        arc = rng.uniform(low, high)
        if np.all(np.abs(taken - arc) > 1.2) and away.holds(arc):
            return float(arc)
    raise NoRoomError(f"no room for so many people on {high - low:.0f} m of route: at most {int((high - low) / 3)} fit")
