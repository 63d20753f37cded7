"""Who is being cast: what is drawn of somebody before they become a person with a behaviour."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import Enum, auto

import numpy as np

from ...slam.errors import InputError
from ..scenes.request import NoRoomError
from ..scenes.scene import Errand, Scene
from .behaviours.behaviour import Behaviour
from .behaviours.companion import companion
from .behaviours.leader import sided
from .behaviours.mind import Mind
from .behaviours.scripted import scripted
from .behaviours.stander import stander
from .behaviours.walker import walker
from .behaviours.wanderer import wanderer
from .body import Physique
from .crowd import Person
from .movement.bodies import Start
from .movement.ground import Ground
from .movement.terrain import Terrain


@dataclass(frozen=True, kw_only=True)
class CastRequest:
    """Whom an episode needs.

    Attributes:
        scene: The building.
        terrain: The same, as walkers see it.
        people: How many walk, the leader included.
        standing: How many more walk to and fro beside the route and stand when the robot comes.
        style: The leader's, None draws one.
        with_leader: Whether the first of the people leads; else all are on their own: the same people in the same
            places as behind a leader, one more being asked for there.
        start_arc: Where along the route the robot starts [m].
        leader_rng: Source of the leader's draws.
        rng: Source of all other draws.
        heedless: Share of the bystanders who do not see the robot.
        heedless_rng: Source of the draws who they are.
        behaviours: Further people, one each, with behaviours of one's own.
        own_rng: Source of their bodies and places.
    """

    scene: Scene
    terrain: Terrain
    people: int
    standing: int
    style: str | None
    with_leader: bool
    start_arc: float
    leader_rng: np.random.Generator
    rng: np.random.Generator
    heedless: float = 0.0
    heedless_rng: np.random.Generator = field(default_factory=np.random.default_rng)
    behaviours: tuple[Behaviour, ...] = ()
    own_rng: np.random.Generator = field(default_factory=np.random.default_rng)


class Part(Enum):
    """What somebody is drawn for."""

    LEADER = auto()
    COMPANION = auto()
    WALKER = auto()
    STANDER = auto()
    SCRIPTED = auto()
    WANDERER = auto()


@dataclass(kw_only=True)
class Draft:
    """What was drawn of one person so far.

    Attributes:
        part: What they are drawn for.
        physique: Sizes.
        pace: Preferred speed [m/s].
        side: Preferred offset from the way [m]; of wanderers: to its right.
        gap: How far ahead of the leader they walk as a companion [m].
        patience: How long they stand held up before they turn round [s].
        rest: How long they stay at the ends of their way [s].
        gives_way: Whether they stop for the group.
        heedless: Whether they do not see the robot, and so do not stop for it either.
        errand: Their script.
        window: Arc lengths between which they walk as a stander [m].
        path: Which path of the terrain they walk on.
        arc: Where on it they begin [m].
        sense: +1 along it, -1 against it.
    """

    part: Part
    physique: Physique
    pace: float
    side: float
    gap: float
    patience: float = 0.0
    rest: float = 0.0
    gives_way: bool = False
    heedless: bool = False
    errand: Errand | None = None
    window: tuple[float, float] = (0.0, 0.0)
    path: int = 0
    arc: float = 0.0
    sense: float = 1.0


WANDERERS_REST_S = 3.0
"""Wanderers stand this long at first: the robot takes for its leader who walks off before it [s]."""


def people_of(drafts: Sequence[Draft], terrain: Terrain, leader: Mind | None) -> list[Person]:
    """Return the people; without a leader the first draft, which was the leader's, is left out."""
    return [_person(draft, terrain, leader) for draft in (drafts if leader is not None else drafts[1:])]


def _person(draft: Draft, terrain: Terrain, leader: Mind | None) -> Person:
    ground = {Part.STANDER: Ground.BESIDE, Part.WANDERER: Ground.ELSEWHERE}.get(draft.part, Ground.ROUTE)
    return Person(
        physique=draft.physique,
        behaviour=_behaviour(draft, leader),
        start=_start(draft, terrain),
        ground=ground,
        path=draft.path,
        heedless=draft.heedless,
    )


def _behaviour(draft: Draft, leader: Mind | None) -> Mind:
    match draft.part:
        case Part.LEADER if leader is not None:
            return sided(leader, draft.side)
        case Part.COMPANION if leader is not None:
            return companion(gap=draft.gap, side=draft.side)
        case Part.STANDER:
            return stander(pace=draft.pace, side=draft.side, window=draft.window)
        case Part.SCRIPTED if draft.errand is not None:
            return scripted(draft.errand)
        case Part.WANDERER:
            return wanderer(
                pace=draft.pace,
                side=draft.side,
                patience=draft.patience,
                rest=draft.rest,
                gives_way=draft.gives_way and not draft.heedless,
                rests_s=WANDERERS_REST_S,
            )
        case _:
            return walker(pace=draft.pace, side=draft.side, heedless=draft.heedless)


def _start(draft: Draft, terrain: Terrain) -> Start:
    """Return the place on the draft's path, as far to its side as there is room."""
    if draft.errand is not None:
        x, y, _ = draft.errand.places[0]
        return Start(x, y, draft.errand.face)
    lateral = draft.side
    if draft.part == Part.WALKER and not terrain.lap:
        lateral = -draft.sense * terrain.passing
    if draft.part == Part.WANDERER:
        lateral = -draft.sense * lateral
    if draft.part != Part.STANDER:
        lateral = terrain.within_free(draft.arc, lateral, draft.path)
    x, y = terrain.place(draft.arc, lateral, draft.path).tolist()
    heading = terrain.ahead(draft.arc, draft.path) + (np.pi if draft.sense < 0.0 else 0.0)
    return Start(x, y, heading, draft.arc, draft.sense, lateral)


def stander_window(scene: Scene, taken: np.ndarray, rng: np.random.Generator) -> tuple[float, float, float]:
    """Return a stretch (from, to, lateral) beside the route [m] on which a stander can walk to and fro.

    Args:
        scene: The building.
        taken: (k,) arc lengths at which somebody is already [m].
        rng: Source of draws.

    Raises:
        InputError: If there are no such places; `NoRoomError` if there is no room at them.
    """
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
    raise NoRoomError(f"no room for another standing person in this {scene.name}")
