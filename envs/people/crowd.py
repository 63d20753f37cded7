"""All people of one world: who they are, where they are, and how their wishes become walking."""

import copy
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .behaviours.behaviour import Behaviour, Wish, checked_wish
from .behaviours.deciding import begin, decide
from .behaviours.leader import DONE
from .behaviours.mind import Around, Mind, MindKind, Minds, minds_of
from .behaviours.view import PersonView, Surroundings
from .body import PARTS, WIDEST, Physique
from .movement.bodies import Bodies, Start, standing_bodies
from .movement.ground import Ground
from .movement.social_force import SocialForceConfig
from .movement.terrain import Terrain
from .movement.things import things_around
from .posture import pose_bodies
from .walk_kernel import Walkers, walk

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Person:
    """One person of an episode; never changes.

    Attributes:
        physique: Sizes.
        behaviour: How it behaves; the episode begins with a copy. People with behaviours of one's own come last.
        start: Where it begins.
        ground: Where it walks.
        path: Which path of the terrain it walks on; 0 is the route.
        heedless: Whether it does not see the robot.
    """

    physique: Physique
    behaviour: Mind | Behaviour
    start: Start
    ground: Ground = Ground.ROUTE
    path: int = 0
    heedless: bool = False


@dataclass(frozen=True, kw_only=True)
class Casting:
    """Who is in the building; never changes.

    Attributes:
        people: Everybody; first those who walk with the robot, the leader at their head.
        group: How many these are; 0 where nobody leads.
    """

    people: tuple[Person, ...]
    group: int

    @property
    def physiques(self) -> tuple[Physique, ...]:
        """Sizes of everybody."""
        return tuple(person.physique for person in self.people)


@dataclass
class CrowdState:
    """All that changes about n people.

    Attributes:
        bodies: Where they are and how they move.
        minds: How the first of them behave, with what they remember.
        behaviours: How the others do, whose behaviours are of one's own.
    """

    bodies: Bodies
    minds: Minds
    behaviours: list[Behaviour]

    @property
    def led(self) -> bool:
        """Whether somebody leads: always the first."""
        return len(self.minds.kind) > 0 and int(self.minds.kind[0]) == MindKind.LEADER

    @property
    def leader_done(self) -> bool:
        """Whether somebody leads and has come to the tour's end."""
        return self.led and bool(self.minds.numbers[0, DONE])


def first_state(casting: Casting) -> CrowdState:
    """Return the state in which everybody stands where they begin."""
    stance = np.array([physique.stance_half_width for physique in casting.physiques])
    bodies = standing_bodies([person.start for person in casting.people], stance)
    behaviours = [person.behaviour for person in casting.people]
    minds = minds_of([behaviour for behaviour in behaviours if isinstance(behaviour, Mind)])
    return CrowdState(bodies, minds, [copy.deepcopy(own) for own in behaviours if isinstance(own, Behaviour)])


class Crowd:
    """Moves the people; itself it never changes: what does is in a `CrowdState`.

    Args:
        terrain: Where they walk.
        casting: Who they are.
        force: The social force.
    """

    def __init__(self, terrain: Terrain, casting: Casting, force: SocialForceConfig) -> None:
        self.casting = casting
        self.terrain = terrain
        self._force = force.as_array()
        sizes = casting.physiques
        self.radius = np.array([p.radius for p in sizes])
        self.leg_radius = np.array([p.leg_radius for p in sizes])
        size = np.array([(p.thigh, p.shin, p.leg_radius, p.stance_half_width, p.walk_ratio) for p in sizes]).reshape(
            -1, 5
        )
        self._ground = np.array([person.ground for person in casting.people], dtype=np.int64)
        path = np.array([person.path for person in casting.people], dtype=np.int64)
        heedless = np.array([person.heedless for person in casting.people], dtype=np.bool_)
        self._walkers = Walkers(size, self.radius, heedless, path, terrain.ways.first[path], terrain.ways.rows[path])
        self._elsewhere = self._ground == Ground.ELSEWHERE
        self._things = things_around(terrain.boxes, terrain.circles, reach_of_things(force))

    def __len__(self) -> int:
        return len(self.casting.people)

    def decide(self, state: CrowdState, dt: float, robot: Array, robot_arc: float, rng: np.random.Generator) -> None:
        """Let everybody wish something for the next `dt` seconds, one after the other, and begin to do it.

        Args:
            state: Where they are.
            dt: Time [s].
            robot: (8,) the robot as in `advance_bodies`.
            robot_arc: Its way along the path [m].
            rng: Source of the draws of behaviours.

        Raises:
            InputError: If a behaviour returns no wish.
        """
        b = state.bodies
        around = Around(
            b.position, b.velocity, b.direction, b.arc, b.sense, b.lateral, b.wish, b.face, b.goal, self._walkers.way,
            self._ground, self._elsewhere, self.casting.group, robot, robot_arc, self.terrain.ways,
        )  # fmt: skip
        decide(state.minds, around, dt)
        seen = Surroundings(around=around, heading=b.heading, terrain=self.terrain, rng=rng)
        for person, behaviour in enumerate(state.behaviours, start=len(state.minds.kind)):
            wish = checked_wish(behaviour.wish(PersonView(person, seen), dt), behaviour)
            begin(person, _compiled(wish), around, dt)

    def advance(self, state: CrowdState, dt: float, robot: Array) -> None:
        """Move everybody of `state` for `dt` seconds; `robot` as in `advance_bodies`."""
        before = np.empty_like(state.bodies.position)
        group, ways = self.casting.group, self.terrain.ways
        walk(dt, state.bodies, self._walkers, group, ways, self._things, self._force, robot, before)

    def pose(self, state: CrowdState, laser_height: float, mocap_position: Array, mocap_quaternion: Array) -> None:
        """Write the parts of all bodies into MuJoCo's mocap arrays (6 n, 3) and (6 n, 4)."""
        b, count = state.bodies, len(self) * len(PARTS)
        pose_bodies(
            b.position,
            b.heading,
            self._walkers.size,
            b.feet,
            b.lift,
            laser_height,
            mocap_position[:count],
            mocap_quaternion[:count],
            b.legs,
        )


def reach_of_things(force: SocialForceConfig) -> float:
    """Return the distance of walls and furniture from a body or a foot beyond which they do not matter [m]."""
    return max(force.obstacle_threshold + WIDEST, 2.0 * WIDEST)


def _compiled(wish: Wish) -> tuple[float, float, float, float, float, float]:
    """Return a wish as compiled behaviours tell it."""
    x, y = (math.nan, math.nan) if wish.goal is None else wish.goal
    return float(wish.speed), float(wish.offset), float(wish.sense), float(wish.face), float(x), float(y)
