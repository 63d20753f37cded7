"""Who is in a building where people have ways of their own, and what they are like."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..scenes.request import NoRoomError
from .behaviours.leader import draw_leader
from .behaviours.mind import Mind
from .body import draw_physique
from .draft import CastRequest, Draft, Part, stander_window

Array = NDArray[np.float64]

MOST_DRAWN = 12
"""Most bystanders where their number is drawn."""
_COMPANY = 0.25
_APART, _FROM_ROBOT = 0.9, 1.8


@dataclass(frozen=True, kw_only=True)
class Temperament:
    """What a kind of bystander is like; ranges from which each person draws.

    Attributes:
        pace: Walking speed [m/s].
        patience: How long they stand held up before they turn round [s].
        rest: How long they stay where their walk ends [s].
        right: How far they keep to the right of the middle of their way [m].
        gives_way: Whether they stop for the leader and the robot.
    """

    pace: tuple[float, float]
    patience: tuple[float, float]
    rest: tuple[float, float]
    right: tuple[float, float]
    gives_way: bool = False


TEMPERAMENTS: dict[str, Temperament] = {
    "calm": Temperament(pace=(0.7, 1.0), patience=(1.5, 3.0), rest=(2.0, 12.0), right=(0.2, 0.5)),
    "hurried": Temperament(pace=(1.1, 1.4), patience=(0.8, 1.5), rest=(0.0, 3.0), right=(0.1, 0.4)),
    "dawdling": Temperament(pace=(0.4, 0.65), patience=(2.0, 4.0), rest=(5.0, 25.0), right=(-0.1, 0.3)),
    "courteous": Temperament(pace=(0.8, 1.1), patience=(1.5, 3.0), rest=(2.0, 10.0), right=(0.3, 0.6), gives_way=True),
}
"""Name -> what such people are like."""


def draw_wanderers(request: CastRequest) -> tuple[list[Draft], Mind]:
    """Draw a leader, now and then somebody with them, wanderers on the scene's walks, and standers.

    Raises:
        NoRoomError: If the building is too small for so many.
    """
    people, rng = request.people, request.rng
    company = people > 1 and rng.random() < _COMPANY
    parts = [Part.LEADER, *[Part.COMPANION] * company, *[Part.WANDERER] * (people - 1 - company)]
    parts += [Part.STANDER] * request.standing
    count = len(parts)
    leader = draw_leader(request.leader_rng, request.style, request.start_arc, request.scene.tour_length)
    physiques = [draw_physique(request.leader_rng), *(draw_physique(rng) for _ in parts[1:])]
    temper = [TEMPERAMENTS[str(name)] for name in rng.choice(sorted(TEMPERAMENTS), count)]
    pace = [float(rng.uniform(*kind.pace)) for kind in temper]
    side = [float(rng.uniform(*kind.right)) for kind in temper]
    gap = rng.uniform(1.1, 1.6, count)
    patience = [float(rng.uniform(*kind.patience)) for kind in temper]
    rest = [float(rng.uniform(*kind.rest)) for kind in temper]
    drafts = [
        Draft(
            part=part,
            physique=physiques[k],
            pace=pace[k],
            side=side[k],
            gap=float(gap[k]),
            patience=patience[k],
            rest=rest[k],
            gives_way=temper[k].gives_way,
        )
        for k, part in enumerate(parts)
    ]
    _place(request, drafts, request.start_arc + request.leader_rng.uniform(1.2, 1.5))
    return drafts, leader


def _place(request: CastRequest, drafts: list[Draft], leader_arc: float) -> None:
    """Give everybody a place, apart from each other, and wanderers a walk."""
    terrain, rng = request.terrain, request.rng
    taken = [terrain.place(request.start_arc, 0.0)]
    order = rng.permutation(len(request.scene.walks)) + 1
    for person, draft in enumerate(drafts):
        if draft.part in (Part.LEADER, Part.COMPANION):
            draft.arc = leader_arc + (draft.gap if draft.part == Part.COMPANION else 0.0)
            draft.side = 0.0
        elif draft.part == Part.STANDER:
            _stand(request, draft, drafts[:person], np.array(taken))
        else:
            draft.sense = float(rng.choice([-1.0, 1.0]))
            draft.path = int(order[person % len(order)])
            draft.arc = _free_arc(request, draft, taken, len(drafts))
        lateral = draft.side * (-draft.sense if draft.part == Part.WANDERER else 1.0)
        taken.append(terrain.place(draft.arc, lateral, draft.path))


def _free_arc(request: CastRequest, draft: Draft, taken: list[Array], people: int) -> float:
    """Return a place on the draft's path that is free; `taken` is where the robot and those before are [m]."""
    terrain, path = request.terrain, draft.path
    length = terrain.length_of(path)
    for _ in range(300):
        arc = float(request.rng.uniform(0.0, length))
        lateral = terrain.within_free(arc, -draft.sense * draft.side, path)
        away = np.hypot(*(np.array(taken) - terrain.place(arc, lateral, path)).T)
        if away[0] > _FROM_ROBOT and np.all(away[1:] > _APART):
            return arc
    raise NoRoomError(f"no room for {people} people in this building: at most about {len(taken) - 1} fit")


def _stand(request: CastRequest, draft: Draft, before: list[Draft], taken: Array) -> None:
    """Give somebody who will stand beside the route a place there; `taken` (k, 2) is where others are [m]."""
    on_route = np.array([other.arc for other in before if other.path == 0])
    for _ in range(100):
        low, high, lateral = stander_window(request.scene, on_route, request.rng)
        if np.hypot(*(taken - request.terrain.place(low + 0.1, lateral)).T).min() > _APART:
            draft.side, draft.window, draft.arc = lateral, (low, high), low + 0.1
            return
    raise NoRoomError(f"no room for another standing person in this {request.scene.name}")
