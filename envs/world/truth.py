"""What is really so in the simulated world; for tests, metrics and the switch `people="truth"` only."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class TruePeople:
    """The people, one row each; world frame.

    Attributes:
        positions: (n, 2) centres of the bodies [m].
        headings: (n,) [rad].
        velocities: (n, 2) [m/s].
        feet: (n, 2, 2) left and right foot (ankle) on the floor; a foot that bears weight stands still [m].
        legs: (n, 2, 2) left and right leg where its axis meets the laser's plane [m].
        radii: (n,) of the bodies [m].
        leg_radii: (n,) largest radius of the shins [m].
        walking: (n,) whether they walk (faster than 0.2 m/s).
    """

    positions: Array
    headings: Array
    velocities: Array
    feet: Array
    legs: Array
    radii: Array
    leg_radii: Array
    walking: NDArray[np.bool_]

    def __len__(self) -> int:
        return len(self.radii)


@dataclass(frozen=True, eq=False)
class TrueState:
    """The world at one time.

    Attributes:
        time_s: Since the start [s].
        robot_pose: (3,) T_world_robot [m, m, rad].
        robot_velocity: (3,) in the robot's frame [m/s, m/s, rad/s].
        people: All people.
        leader_index: Row of the leader, -1 without one.
        leader_walking: Whether the leader means to walk now and does.
        contact_person: Whether the robot touched a person in the last control period.
        contact_static: Whether the robot touched a wall or furniture in the last control period.
        tour_done: Whether the leader has ended the tour and the robot stands within 2 m of them; without a leader,
            whether the robot has come to the tour's end.
        robot_progress: Way of the robot along the route [m].
    """

    time_s: float
    robot_pose: Array
    robot_velocity: Array
    people: TruePeople
    leader_index: int
    leader_walking: bool
    contact_person: bool
    contact_static: bool
    tour_done: bool
    robot_progress: float
