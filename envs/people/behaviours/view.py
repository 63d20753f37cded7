"""What one person sees when it decides what to do: itself, its way, the robot and the other people."""

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from ..movement.bodies import Bodies
from ..movement.meeting import first_coming, group_comes
from ..movement.terrain import Terrain

Array = NDArray[np.float64]


class Ground(IntEnum):
    """Where somebody walks; the group around the robot goes by it to see who comes towards them."""

    ROUTE = 0
    """On the robot's route: comes towards the group if against its direction."""
    BESIDE = 1
    """To and fro at one place beside the route: the group makes room there whichever way this person goes."""
    ELSEWHERE = 2
    """On other ways, or freely: comes towards the group if it walks towards it."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Surroundings:
    """What all n people see alike at one time.

    Attributes:
        bodies: Everybody's body.
        terrain: The building.
        path: (n,) which path of the terrain each walks on; 0 is the route.
        ground: (n,) `Ground` of each.
        group: How many of them, the first ones, walk with the robot: the leader, and who keeps the leader company.
        robot: (8,) the robot as in `walking.advance_bodies`.
        robot_arc: Its way along the route [m].
        robot_distance: (n,) distances of the bodies from it, centre to centre [m].
        rng: Source of draws of those who decide.
    """

    bodies: Bodies
    terrain: Terrain
    path: NDArray[np.int64]
    ground: NDArray[np.int64]
    group: int
    robot: Array
    robot_arc: float
    robot_distance: Array
    rng: np.random.Generator


class OwnWay:
    """A person's way, seen from where the person is on it.

    Args:
        terrain: The building.
        path: Which of its paths; 0 is the robot's route.
        arc: How far along it the person is [m].
    """

    __slots__ = ("_path", "_terrain", "arc")

    def __init__(self, terrain: Terrain, path: int, arc: float) -> None:
        self._terrain, self._path, self.arc = terrain, path, arc

    @property
    def length(self) -> float:
        """Length of the way [m]."""
        return self._terrain.length_of(self._path)

    @property
    def lap(self) -> float:
        """Length of one lap where the robot's route is a closed lap, else 0 [m]."""
        return self._terrain.lap

    @property
    def heading(self) -> float:
        """Direction of the way where the person is [rad]."""
        return self._terrain.ahead(self.arc, self._path)

    @property
    def recorded_speed(self) -> float:
        """Speed at which somebody was recorded here [m/s]; NaN where nobody was."""
        return self._terrain.recorded_speed(self.arc, self._path)

    @property
    def passing(self) -> float:
        """Offset from the route at which somebody passes the group around the robot [m]."""
        return self._terrain.passing

    @property
    def turn_out(self) -> float:
        """Offset from the route to which that group turns out for whom it meets [m]."""
        return self._terrain.turn_out

    @property
    def bends(self) -> bool:
        """Whether the route bends nearby."""
        return self._terrain.in_bend(self.arc)

    def within_free(self, offset: float) -> float:
        """Return the offset nearest to `offset` [m] at which nothing stands beside the way here."""
        return self._terrain.within_free(self.arc, offset, self._path)

    def narrows_before(self, front: float) -> bool:
        """Return whether two can pass here, but not on all of the next 2.5 m back along the route; to `front` [m]."""
        return self._terrain.narrows_before(self.arc, front)


class PersonView:
    """What one person sees at the moment it decides.

    Args:
        person: Row of the person.
        around: What all see alike.

    Attributes:
        person: Row of the person in arrays of all people.
        arc: How far along its way it is [m].
        sense: +1 if it walks along its way, -1 if against it.
        speed: Speed that it wants at present [m/s]; others may slow it down.
        face: Direction that it last wished to look in while standing [rad]; NaN: anywhere.
        way: Its way; the robot's route for people of one's own.
        robot_arc: How far along its route the robot is [m].
        robot_distance: Distance from the robot, centre to centre [m].
        rng: Source of random numbers; one for all who decide.
    """

    __slots__ = ("_around", "arc", "face", "person", "rng", "robot_arc", "robot_distance", "sense", "speed", "way")

    def __init__(self, person: int, around: Surroundings) -> None:
        bodies = around.bodies
        self._around, self.person, self.rng = around, person, around.rng
        self.arc, self.sense = float(bodies.arc[person]), float(bodies.sense[person])
        self.speed, self.face = float(bodies.wish[person]), float(bodies.face[person])
        self.way = OwnWay(around.terrain, int(around.path[person]), self.arc)
        self.robot_arc, self.robot_distance = around.robot_arc, float(around.robot_distance[person])

    @property
    def position(self) -> Array:
        """(2,) where the person is, world frame [m]."""
        return self._around.bodies.position[self.person].copy()

    @property
    def velocity(self) -> Array:
        """(2,) how it really moves [m/s]."""
        return self._around.bodies.velocity[self.person].copy()

    @property
    def heading(self) -> float:
        """Direction of its body [rad]."""
        return float(self._around.bodies.heading[self.person])

    @property
    def robot_position(self) -> Array:
        """(2,) where the robot is [m]."""
        return self._around.robot[:2].copy()

    @property
    def robot_velocity(self) -> Array:
        """(2,) how it moves over ground [m/s]."""
        return self._around.robot[4:6].copy()

    @property
    def robot_direction(self) -> float:
        """Direction from the person to the robot, world frame [rad]."""
        position, robot = self._around.bodies.position, self._around.robot
        return float(np.arctan2(robot[1] - position[self.person, 1], robot[0] - position[self.person, 0]))

    @property
    def other_positions(self) -> Array:
        """(n - 1, 2) where all other people are [m]; the leader, if there is one, comes first."""
        return np.delete(self._around.bodies.position, self.person, axis=0)

    @property
    def other_velocities(self) -> Array:
        """(n - 1, 2) how they move [m/s], in the same order."""
        return np.delete(self._around.bodies.velocity, self.person, axis=0)

    @property
    def leader_arc(self) -> float:
        """How far along the route the leader is [m]; only where somebody leads."""
        return float(self._around.bodies.arc[0])

    @property
    def leader_speed(self) -> float:
        """Speed that the leader wants at present [m/s]; only where somebody leads."""
        return float(self._around.bodies.wish[0])

    @property
    def group_arcs(self) -> list[float]:
        """How far along the route those are who walk with the robot [m], the leader first; [] where nobody leads."""
        return self._around.bodies.arc[: self._around.group].tolist()

    def group_comes(self) -> bool:
        """Return whether the robot or one of its group is within 2 m before this person, walking towards it."""
        around, b = self._around, self._around.bodies
        return bool(group_comes(self.person, around.group, around.robot, b.position, b.velocity, b.direction))

    def first_met(self) -> float | None:
        """Return the present offset [m] of the first of those who come towards this one of the group; None: nobody."""
        around, b = self._around, self._around.bodies
        elsewhere = around.ground == Ground.ELSEWHERE
        coming = int(first_coming(self.person, elsewhere, b.position, b.velocity, b.direction))
        for other in range(around.group, len(elsewhere) if coming < 0 else coming):
            if elsewhere[other]:
                continue
            comes = b.sense[other] < 0.0 or around.ground[other] == Ground.BESIDE
            if comes and -1.0 < b.arc[other] - self.arc < 6.0:
                return float(b.lateral[other])
        return float(b.lateral[coming]) if coming >= 0 else None
