"""What happened in an episode, row by row; everything that is measured is measured on this, never on the simulator."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
SAME_TIME_S = 1e-6
"""Times that differ by no more are the same: they are sums and differences of steps [s]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class History:
    """Row 0 is the state after `reset`, row k the state after step k; n rows, p people (the leader among them).

    The world frame is the simulator's. All arrays are read-only.

    Attributes:
        time_s: (n,) simulated time [s].
        robot_pose: (n, 3) true pose [m, m, rad].
        robot_velocity: (n, 3) true velocity in the robot frame (forward, left, turn) [m/s, m/s, rad/s].
        action: (n, a) action that led to the row, cut to [-1, 1]; row 0 is zero.
        reward: (n,) reward of the step; row 0 is zero.
        reward_terms: name -> (n,); the terms of a row sum to its reward.
        person_position: (n, p, 2) true centres [m].
        person_velocity: (n, p, 2) true velocities [m/s].
        leader_walking: (n,) whether the leader is walking.
        contact_person: (n,) whether the robot touched a person during the step.
        contact_static: (n,) whether the robot touched the building or a thing in it during the step.
        odometry: (n, 3) wheel odometry T_odom_robot.
        estimated_pose: (n, 3) T_map_robot by the SLAM engine; NaN without one.
        leader_visible: (n,) whether the robot saw the person it takes for its leader.
        leader_id: (n,) identity of that person's track; -1 while there is none.
        leader_estimate: (n, 2) where the robot believes its leader to be, carried into the world by the true pose [m];
            NaN while there is none.
        tracked_people: (n,) how many people the robot tracks.
        tour_done: (n,) whether the leader's tour is over.
        person_radius: (p,) radii of the bodies [m].
        robot_radius: Radius of the robot's enclosing circle [m].
        leader_index: Which person leads; -1 for nobody.
        static_clearance: (n,) from the robot's centre to the nearest thing that it could hit [m].
        coverage: (n,) share of the floor seen so far; NaN where it was not measured.
    """

    time_s: Array
    robot_pose: Array
    robot_velocity: Array
    action: Array
    reward: Array
    reward_terms: Mapping[str, Array]
    person_position: Array
    person_velocity: Array
    leader_walking: Flags
    contact_person: Flags
    contact_static: Flags
    odometry: Array
    estimated_pose: Array
    leader_visible: Flags
    leader_id: NDArray[np.int64]
    leader_estimate: Array
    tracked_people: NDArray[np.int64]
    tour_done: Flags
    person_radius: Array
    robot_radius: float
    leader_index: int
    static_clearance: Array
    coverage: Array = field(default_factory=lambda: np.full(1, np.nan))

    def __post_init__(self) -> None:
        for entry in fields(self):
            value = getattr(self, entry.name)
            if isinstance(value, np.ndarray):
                value.setflags(write=False)

    def __len__(self) -> int:
        return len(self.time_s)

    @property
    def step_s(self) -> float:
        """Time between two rows [s]."""
        return float(self.time_s[1] - self.time_s[0])

    @property
    def leader_position(self) -> Array:
        """(n, 2) true position of the leader [m]; there must be one."""
        return self.person_position[:, self.leader_index]

    @property
    def bystanders(self) -> NDArray[np.int64]:
        """Indices of the people who do not lead."""
        return np.setdiff1d(np.arange(self.person_position.shape[1]), self.leader_index)

    @property
    def surface_distance(self) -> Array:
        """(n, p) free space between the robot's circle and each person's [m]; negative where they overlap."""
        centre = np.linalg.norm(self.person_position - self.robot_pose[:, None, :2], axis=-1)
        return centre - self.robot_radius - self.person_radius


def run_lengths(flags: Flags) -> list[tuple[int, int]]:
    """Return (start, end) of each maximal run of true values of `flags` (n,), end excluded."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], flags, [False])).astype(np.int8)))
    return [(int(start), int(end)) for start, end in zip(edges[::2], edges[1::2], strict=True)]
