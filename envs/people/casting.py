"""Who is in the building at the start, and where."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...slam.errors import InputError
from ..scenes.scene import Errand, Scene
from .body import Physique, draw_physique
from .crowd import Casting, CrowdState, Role
from .leader import LeadingPedestrian, draw_leader
from .movement.terrain import Terrain

Array = NDArray[np.float64]

MOST_ON_ROUTE = 3
"""Most bystanders where their number is drawn and all walk on the leader's way."""
_FROM_ROBOT, _FROM_PEOPLE = 1.2, 0.6  # walkers begin no nearer, centre to centre [m]


def cast_people(
    scene: Scene,
    terrain: Terrain,
    people: int,
    standing: int,
    style: str | None,
    with_leader: bool,
    start_arc: float,
    leader_rng: np.random.Generator,
    rng: np.random.Generator,
) -> tuple[Casting, CrowdState]:
    """Draw the people of one episode.

    Args:
        scene: The building.
        terrain: The same, as walkers see it.
        people: How many walk, the leader included; the second of them walks ahead of the robot with the leader.
        standing: How many more walk to and fro beside the route and stand when the robot comes.
        style: The leader's, None draws one.
        with_leader: Whether the first of the people leads; else all are on their own: the same people in the same
            places as behind a leader, one more being asked for there.
        start_arc: Where along the route the robot starts [m].
        leader_rng: Source of the leader's draws.
        rng: Source of all other draws.

    The scripted people of the scene come last.

    Raises:
        InputError: If the building is too small for so many.
    """
    if not with_leader:
        led = cast_people(scene, terrain, people + 1, standing, style, True, start_arc, leader_rng, rng)
        return without_leader(*led)
    roles = [Role.LEADER, Role.COMPANION][:people] + [Role.WALKER] * (people - 2) + [Role.STANDER] * standing
    roles += [Role.SCRIPTED] * len(scene.errands)
    count = len(roles)
    leader = draw_leader(leader_rng, style, start_arc, scene.tour_length)
    leader_physique = draw_physique(leader_rng)
    physiques = [draw_physique(rng) for _ in range(count)]
    physiques[0] = leader_physique
    casting = _cast(np.array(roles, dtype=np.int64), physiques, scene, rng)
    arc, sense = _places(scene, terrain, casting, start_arc, start_arc + leader_rng.uniform(1.2, 1.5), rng)
    return casting, standing_still(terrain, casting, arc, sense, leader)


def _cast(roles: NDArray[np.int64], physiques: list[Physique], scene: Scene, rng: np.random.Generator) -> Casting:
    count = len(roles)
    return Casting(
        roles=roles,
        physiques=tuple(physiques),
        pace=np.where(roles == Role.STANDER, rng.uniform(0.5, 0.8, count), rng.uniform(0.7, 1.15, count)),
        side=rng.uniform(-0.1, 0.1, count),
        gap=rng.uniform(1.1, 1.6, count),
        window=np.zeros((count, 2)),
        **nobody_wanders(count),
        errands=scene.errands,
    )


def nobody_wanders(count: int) -> dict[str, Any]:
    """Return the fields of a `Casting` of `count` people that only wanderers need."""
    return {
        "path": np.zeros(count, dtype=np.int64),
        "patience": np.zeros(count),
        "rest": np.zeros(count),
        "gives_way": np.zeros(count, dtype=bool),
    }


def without_leader(casting: Casting, state: CrowdState) -> tuple[Casting, CrowdState]:
    """Return the same people without the first of them; who walked with the leader is on their own."""
    roles = np.where(casting.roles == Role.COMPANION, Role.WALKER, casting.roles)[1:]
    names = ("pace", "side", "gap", "window", "path", "patience", "rest", "gives_way")
    rows = {name: getattr(casting, name)[1:] for name in names}
    people = {name: value[1:] for name, value in vars(state).items() if name != "leader"}
    kept = Casting(roles=roles, physiques=casting.physiques[1:], **rows, errands=casting.errands)
    return kept, CrowdState(**people, leader=None)


def _places(
    scene: Scene, terrain: Terrain, casting: Casting, start_arc: float, leader_arc: float, rng: np.random.Generator
) -> tuple[Array, Array]:
    """Return arc length and sense of everybody, 1.2 m apart; writes side and window of standers into `casting`."""
    length = scene.tour_length
    arc, sense = np.zeros(len(casting.roles)), np.ones(len(casting.roles))
    away = _Away(terrain, start_arc, scene.errands)
    for person, role in enumerate(casting.roles):
        if role == Role.LEADER:
            arc[person] = leader_arc
        elif role == Role.SCRIPTED:
            continue
        elif role == Role.COMPANION:
            arc[person] = leader_arc + casting.gap[person]
            casting.side[person] *= 10.0 * max(0.0, min(0.3, scene.half_width - 0.5))
        elif role == Role.WALKER:
            low, high = (0.3 * scene.lap, 0.75 * scene.lap) if scene.lap else (6.0, length - 1.0)
            arc[person] = _apart(low + leader_arc, min(high + leader_arc, length), arc[:person], away, rng)
            sense[person] = 1.0 if scene.lap else rng.choice([-1.0, 1.0])
        else:
            place = stander_window(scene, arc[:person], rng)
            arc[person], casting.side[person] = place[0] + 0.1, place[2]
            casting.window[person] = place[:2]
        aside = terrain.passing if role == Role.WALKER and not scene.lap else float(casting.side[person])
        away.take(float(arc[person]), -sense[person] * aside if role == Role.WALKER else aside)
    return arc, sense


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
    raise InputError(f"no room for so many people on {high - low:.0f} m of route: at most {int((high - low) / 3)} fit")


def stander_window(scene: Scene, taken: Array, rng: np.random.Generator) -> tuple[float, float, float]:
    """Return a stretch (from, to, lateral) beside the route on which a stander can walk to and fro."""
    places = scene.standing_places
    if len(places) == 0:
        raise InputError(f"nobody can stand beside the route of this {scene.name}: `standing` must be 0")
    limit = 0.6 * (scene.lap or scene.tour_length) + 4.0
    for attempt in range(900):
        length, beside = ((1.6, 1.0), (1.0, 1.0), (0.5, 0.4))[attempt // 300]
        start, lateral = places[rng.integers(len(places))]
        same = np.abs(places[:, 1] - lateral) < 1e-9
        covered = same & (places[:, 0] > start - 0.05) & (places[:, 0] < start + length + 0.05)
        apart = np.all(np.abs(taken - start - length / 2.0) > beside + length / 2.0)
        if covered.sum() >= 5.0 * length and 4.0 < start < limit and apart:
            return float(start + 0.2 * length), float(start + 0.8 * length), float(lateral)
    raise InputError(f"no room for another standing person in this {scene.name}")


def standing_still(
    terrain: Terrain, casting: Casting, arc: Array, sense: Array, leader: LeadingPedestrian | None
) -> CrowdState:
    """Return the state in which everybody stands on both feet at their place, looking along their way."""
    count = len(arc)
    lateral = casting.side.copy()
    for person, role in enumerate(casting.roles):
        if role == Role.WALKER and not terrain.lap:
            lateral[person] = -sense[person] * terrain.passing
        if role == Role.WANDERER:
            lateral[person] = -sense[person] * lateral[person]
        if role not in (Role.STANDER, Role.SCRIPTED):
            lateral[person] = terrain.within_free(arc[person], lateral[person], int(casting.path[person]))
    places = [(float(a), float(side), int(path)) for a, side, path in zip(arc, lateral, casting.path, strict=True)]
    position = np.array([terrain.place(*place) for place in places]).reshape(-1, 2)
    heading = np.array([terrain.ahead(a, path) for a, _, path in places]) + np.where(sense < 0.0, np.pi, 0.0)
    for person, errand in enumerate(casting.errands, start=count - len(casting.errands)):
        position[person], heading[person], lateral[person] = errand.places[0][:2], errand.face, 0.0
    stance = np.array([p.stance_half_width for p in casting.physiques])
    left = stance[:, None] * np.stack((-np.sin(heading), np.cos(heading)), axis=-1)
    return CrowdState(
        position=position,
        velocity=np.zeros((count, 2)),
        heading=heading,
        feet=np.stack((position + left, position - left), axis=1),
        origin=np.zeros((count, 2)),
        lift=np.zeros((count, 2)),
        phase=np.zeros(count),
        swing=np.full(count, -1, dtype=np.int64),
        legs=np.zeros((count, 2, 2)),
        arc=arc,
        sense=sense,
        lateral=lateral,
        wish=np.zeros(count),
        face=np.full(count, np.nan),
        timer=np.zeros(count),
        errand=np.zeros(count, dtype=np.int64),
        leader=leader,
    )
