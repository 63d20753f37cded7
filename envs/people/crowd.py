"""All people of one world: who they are, where they are, and how their wishes become walking."""

import copy
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .behaviours.behaviour import Behaviour, checked_wish
from .behaviours.leader import Leader
from .behaviours.view import Ground, PersonView, Surroundings
from .body import PARTS, Physique
from .gait import advance_gait, pose_bodies
from .movement.bodies import Bodies, Start, standing_bodies
from .movement.social_force import SocialForceConfig
from .movement.terrain import Terrain
from .movement.walking import advance_bodies, locate, turn_bodies, wanted_directions

Array = NDArray[np.float64]

_SPEED_UP, _SLOW_DOWN = 0.7, 1.0  # how fast a wished speed is taken up and given up [m/s^2]
_SIDESTEP = 0.4  # how fast a wished offset is [m/s]
_LAP_END = 1.5  # so far before the end of a route of several laps its start takes over [m]


@dataclass(frozen=True, kw_only=True)
class Person:
    """One person of an episode; never changes.

    Attributes:
        physique: Sizes.
        behaviour: How it behaves; the episode begins with a copy.
        start: Where it begins.
        ground: Where it walks.
        path: Which path of the terrain it walks on; 0 is the route.
    """

    physique: Physique
    behaviour: Behaviour
    start: Start
    ground: Ground = Ground.ROUTE
    path: int = 0


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
        behaviours: How each behaves, with what it remembers.
    """

    bodies: Bodies
    behaviours: list[Behaviour]

    @property
    def leader(self) -> Leader | None:
        """Who leads, always the first; None where nobody does."""
        first = self.behaviours[0] if self.behaviours else None
        return first if isinstance(first, Leader) else None


def first_state(casting: Casting) -> CrowdState:
    """Return the state in which everybody stands where they begin."""
    stance = np.array([physique.stance_half_width for physique in casting.physiques])
    bodies = standing_bodies([person.start for person in casting.people], stance)
    return CrowdState(bodies, [copy.deepcopy(person.behaviour) for person in casting.people])


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
        self._size = np.array(
            [(p.thigh, p.shin, p.leg_radius, p.stance_half_width, p.walk_ratio) for p in sizes]
        ).reshape(-1, 5)
        self._ground = np.array([person.ground for person in casting.people], dtype=np.int64)
        self._path = np.array([person.path for person in casting.people], dtype=np.int64)
        self._first, self._count = terrain.first[self._path], terrain.count[self._path]

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
        bodies = state.bodies
        around = Surroundings(
            bodies=bodies,
            terrain=self.terrain,
            path=self._path,
            ground=self._ground,
            group=self.casting.group,
            robot=robot,
            robot_arc=robot_arc,
            robot_distance=np.hypot(bodies.position[:, 0] - robot[0], bodies.position[:, 1] - robot[1]),
            rng=rng,
        )
        for person, behaviour in enumerate(state.behaviours):
            wish = checked_wish(behaviour.wish(PersonView(person, around), dt), behaviour)
            change = min(max(wish.speed - bodies.wish[person], -_SLOW_DOWN * dt), _SPEED_UP * dt)
            bodies.wish[person] = max(0.0, bodies.wish[person] + change)
            shift = wish.offset - bodies.lateral[person]
            bodies.lateral[person] += min(max(shift, -_SIDESTEP * dt), _SIDESTEP * dt)
            bodies.sense[person], bodies.face[person] = wish.sense, wish.face
            bodies.goal[person] = (np.nan, np.nan) if wish.goal is None else wish.goal

    def advance(self, state: CrowdState, dt: float, robot: Array) -> None:
        """Move everybody of `state` for `dt` seconds; `robot` as in `advance_bodies`."""
        b, terrain = state.bodies, self.terrain
        ways = (terrain.paths, terrain.tangents, self._first, self._count)
        wanted_directions(b.position, b.arc, b.sense, b.lateral, *ways, b.direction)
        _go_straight(b)
        advance_bodies(
            dt,
            b.position,
            b.velocity,
            b.heading,
            b.direction,
            b.wish,
            self.radius,
            robot,
            terrain.boxes,
            terrain.circles,
            self._force,
        )
        self._close_laps(b)
        locate(b.position, b.arc, *ways)
        turn_bodies(dt, b.velocity, b.direction, b.wish, b.face, b.heading)
        advance_gait(
            dt,
            b.position,
            b.velocity,
            b.heading,
            self._size,
            b.feet,
            b.origin,
            b.lift,
            b.phase,
            b.swing,
            terrain.boxes,
            terrain.circles,
        )

    def pose(self, state: CrowdState, laser_height: float, mocap_position: Array, mocap_quaternion: Array) -> None:
        """Write the parts of all bodies into MuJoCo's mocap arrays (6 n, 3) and (6 n, 4)."""
        b, count = state.bodies, len(self) * len(PARTS)
        pose_bodies(
            b.position,
            b.heading,
            self._size,
            b.feet,
            b.lift,
            laser_height,
            mocap_position[:count],
            mocap_quaternion[:count],
            b.legs,
        )

    def _close_laps(self, bodies: Bodies) -> None:
        """Carry those who do not belong to the group from the end of a route of several laps back to its start."""
        lap = self.terrain.lap
        if lap > 0.0:
            free = (np.arange(len(self)) >= self.casting.group) & (self._path == 0)
            ahead = free & (bodies.arc > self.terrain.length - _LAP_END)
            bodies.arc[ahead] -= lap


def _go_straight(bodies: Bodies) -> None:
    """Point those who have a goal to it."""
    for person in np.flatnonzero(~np.isnan(bodies.goal[:, 0])).tolist():
        dx, dy = (bodies.goal[person] - bodies.position[person]).tolist()
        away = max(math.hypot(dx, dy), 1e-6)
        bodies.direction[person] = (dx / away, dy / away)
