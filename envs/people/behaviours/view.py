"""What one person sees when it decides what to do: itself, its way, the robot and the other people."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..movement.meeting import group_comes
from ..movement.terrain import Terrain
from .making_room import first_met
from .mind import Around

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False, kw_only=True)
class Surroundings:
    """What all people see alike at one time.

    Attributes:
        around: Everybody, their ways and the robot.
        heading: (n,) directions of the bodies [rad].
        terrain: The building.
        rng: Source of draws of those who decide.
    """

    around: Around
    heading: Array
    terrain: Terrain
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

    __slots__ = (
        "_around", "_heading", "arc", "face", "person", "rng", "robot_arc", "robot_distance", "sense", "speed", "way",
    )  # fmt: skip

    def __init__(self, person: int, around: Surroundings) -> None:
        seen = around.around
        self._around, self._heading, self.person, self.rng = seen, around.heading, person, around.rng
        self.arc, self.sense = float(seen.arc[person]), float(seen.sense[person])
        self.speed, self.face = float(seen.wish[person]), float(seen.face[person])
        self.way = OwnWay(around.terrain, int(seen.way[person]), self.arc)
        self.robot_arc = seen.robot_arc
        x, y = (seen.position[person] - seen.robot[:2]).tolist()
        self.robot_distance = math.hypot(x, y)

    @property
    def position(self) -> Array:
        """(2,) where the person is, world frame [m]."""
        return self._around.position[self.person].copy()

    @property
    def velocity(self) -> Array:
        """(2,) how it really moves [m/s]."""
        return self._around.velocity[self.person].copy()

    @property
    def heading(self) -> float:
        """Direction of its body [rad]."""
        return float(self._heading[self.person])

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
        position, robot = self._around.position, self._around.robot
        return float(np.arctan2(robot[1] - position[self.person, 1], robot[0] - position[self.person, 0]))

    @property
    def other_positions(self) -> Array:
        """(n - 1, 2) where all other people are [m]; the leader, if there is one, comes first."""
        return np.delete(self._around.position, self.person, axis=0)

    @property
    def other_velocities(self) -> Array:
        """(n - 1, 2) how they move [m/s], in the same order."""
        return np.delete(self._around.velocity, self.person, axis=0)

    @property
    def leader_arc(self) -> float:
        """How far along the route the leader is [m]; only where somebody leads."""
        return float(self._around.arc[0])

    @property
    def leader_speed(self) -> float:
        """Speed that the leader wants at present [m/s]; only where somebody leads."""
        return float(self._around.wish[0])

    @property
    def group_arcs(self) -> list[float]:
        """How far along the route those are who walk with the robot [m], the leader first; [] where nobody leads."""
        return self._around.arc[: self._around.group].tolist()

    def group_comes(self) -> bool:
        """Return whether the robot or one of its group is within 2 m before this person, walking towards it."""
        a = self._around
        return bool(group_comes(self.person, a.group, a.robot, a.position, a.velocity, a.direction))

    def first_met(self) -> float | None:
        """Return the present offset [m] of the first of those who come towards this one of the group; None: nobody."""
        met = float(first_met(self.person, self._around))
        return None if math.isnan(met) else met
