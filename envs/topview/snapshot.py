"""All that one picture shows, as plain arrays in the world frame."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...slam.occupancy_map import OccupancyMap

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class DrawnTracks:
    """People as the robot perceives them.

    Attributes:
        positions: (n, 2) [m].
        velocities: (n, 2) over ground [m/s].
        ids: (n,) identities.
        leader_id: Identity taken for the leader; -1 for none.
        leader: (2,) where the leader is taken to be [m]; None while there is none.
        leader_visible: Whether the leader is seen.
    """

    positions: Array
    velocities: Array
    ids: NDArray[np.int64]
    leader_id: int
    leader: Array | None
    leader_visible: bool


@dataclass(frozen=True, eq=False)
class Snapshot:
    """One moment.

    Attributes:
        time_s: Simulated time [s].
        robot_pose: (3,) true pose.
        robot_size: (length, width) [m].
        person_positions: (p, 2) true centres [m].
        person_headings: (p,) [rad].
        person_feet: (p, 2, 2) [m].
        leader_index: Which person leads; -1 for nobody.
        scan_points: (n, 2) returns of the latest scan [m].
        scan_dropped: (n,) whether the people filter dropped the return.
        tracks: People as perceived.
        map: The growing map; None without SLAM.
        T_world_map: (3,) where the map frame lies in the world: the robot's first pose.
        path: (m, 2) the robot's path so far [m].
        captions: (label, value) lines of text.
    """

    time_s: float
    robot_pose: Array
    robot_size: tuple[float, float]
    person_positions: Array
    person_headings: Array
    person_feet: Array
    leader_index: int
    scan_points: Array
    scan_dropped: NDArray[np.bool_]
    tracks: DrawnTracks
    map: OccupancyMap | None
    T_world_map: Array
    path: Array
    captions: tuple[tuple[str, str], ...]
