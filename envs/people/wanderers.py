"""Who is in a building where people have ways of their own, and what they are like."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...slam.errors import InputError
from ..scenes.scene import Scene
from .body import draw_physique
from .casting import stander_window, standing_still, without_leader
from .crowd import Casting, CrowdState, Role
from .leader import draw_leader
from .movement.terrain import Terrain
from .movement.walking import SPACING

Array = NDArray[np.float64]

MOST_DRAWN = 12
"""Most bystanders where their number is drawn."""
_COMPANY = 0.25
_APART, _FROM_ROBOT = 0.9, 1.8
_LEADER_FIRST_S = 3.0  # wanderers stand this long at first: the robot takes for its leader who walks off before it


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


def cast_wanderers(
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
    """Draw the people of one episode: a leader, now and then somebody with them, wanderers on the scene's walks.

    Arguments, results and errors are those of `cast_people`.
    """
    if not with_leader:
        led = cast_wanderers(scene, terrain, people + 1, standing, style, True, start_arc, leader_rng, rng)
        return without_leader(*led)
    company = people > 1 and rng.random() < _COMPANY
    roles = [Role.LEADER, *[Role.COMPANION] * company, *[Role.WANDERER] * (people - 1 - company)]
    roles += [Role.STANDER] * standing
    count = len(roles)
    leader = draw_leader(leader_rng, style, start_arc, scene.tour_length)
    physiques = [draw_physique(leader_rng), *(draw_physique(rng) for _ in roles[1:])]
    temper = [TEMPERAMENTS[str(name)] for name in rng.choice(sorted(TEMPERAMENTS), count)]
    casting = Casting(
        roles=np.array(roles, dtype=np.int64),
        physiques=tuple(physiques),
        pace=np.array([rng.uniform(*kind.pace) for kind in temper]),
        side=np.array([rng.uniform(*kind.right) for kind in temper]),
        gap=rng.uniform(1.1, 1.6, count),
        window=np.zeros((count, 2)),
        path=np.zeros(count, dtype=np.int64),
        patience=np.array([rng.uniform(*kind.patience) for kind in temper]),
        rest=np.array([rng.uniform(*kind.rest) for kind in temper]),
        gives_way=np.array([kind.gives_way for kind in temper]),
    )
    arc, sense = _places(scene, terrain, casting, start_arc, start_arc + leader_rng.uniform(1.2, 1.5), rng)
    state = standing_still(terrain, casting, arc, sense, leader)
    state.timer[casting.roles == Role.WANDERER] = -_LEADER_FIRST_S
    return casting, state


def _places(
    scene: Scene, terrain: Terrain, casting: Casting, start_arc: float, leader_arc: float, rng: np.random.Generator
) -> tuple[Array, Array]:
    """Return arc length and sense of everybody, apart from each other; writes side, window and path into `casting`."""
    count = len(casting.roles)
    arc, sense = np.zeros(count), np.ones(count)
    taken = [terrain.place(start_arc, 0.0)]
    order = rng.permutation(len(scene.walks)) + 1
    for person, role in enumerate(casting.roles):
        if role in (Role.LEADER, Role.COMPANION):
            arc[person] = leader_arc + (casting.gap[person] if role == Role.COMPANION else 0.0)
            casting.side[person] = 0.0
        elif role == Role.STANDER:
            arc[person] = _stand(scene, terrain, casting, person, arc, np.array(taken), rng)
        else:
            sense[person] = rng.choice([-1.0, 1.0])
            casting.path[person] = order[person % len(order)]
            arc[person] = _free_arc(terrain, casting, person, float(sense[person]), taken, rng)
        lateral = float(casting.side[person]) * (-sense[person] if role == Role.WANDERER else 1.0)
        taken.append(terrain.place(float(arc[person]), lateral, int(casting.path[person])))
    return arc, sense


def _free_arc(
    terrain: Terrain, casting: Casting, person: int, sense: float, taken: list[Array], rng: np.random.Generator
) -> float:
    path = int(casting.path[person])
    length = float(terrain.count[path] - 1) * SPACING
    for _ in range(300):
        arc = float(rng.uniform(0.0, length))
        lateral = terrain.within_free(arc, -sense * float(casting.side[person]), path)
        away = np.hypot(*(np.array(taken) - terrain.place(arc, lateral, path)).T)
        if away[0] > _FROM_ROBOT and np.all(away[1:] > _APART):
            return arc
    raise InputError(f"no room for {len(casting.roles)} people in this building: at most about {len(taken) - 1} fit")


def _stand(
    scene: Scene,
    terrain: Terrain,
    casting: Casting,
    person: int,
    arc: Array,
    taken: Array,
    rng: np.random.Generator,
) -> float:
    """Return where somebody who will stand beside the route begins; writes their side and window into `casting`."""
    for _ in range(100):
        low, high, lateral = stander_window(scene, arc[:person][casting.path[:person] == 0], rng)
        if np.hypot(*(taken - terrain.place(low + 0.1, lateral)).T).min() > _APART:
            casting.side[person], casting.window[person] = lateral, (low, high)
            return low + 0.1
    raise InputError(f"no room for another standing person in this {scene.name}")
