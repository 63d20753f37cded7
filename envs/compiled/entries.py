"""Entries of the observation that tell of people, as the robot of one world knows them."""

import math

from ...slam.view_kernel import inner_view_kernel
from ..task.observation import FARTHEST_M, FASTEST_MPS
from .leading import Known
from .state import Array, Floats


@inner_view_kernel
def leader_entry(chosen: bool, place: Array, trust: float, visible: float, odometry: Array, entry: Floats) -> None:
    """Write the leader at `place` (4,), odometry frame, in the robot's frame; zeros before one was `chosen`."""
    entry[:] = 0.0
    if chosen:
        _in_robot_frame(odometry, place[0], place[1], place[2], place[3], entry)
        entry[4], entry[5] = trust, visible


@inner_view_kernel
def _in_robot_frame(odometry: Array, x: float, y: float, vx: float, vy: float, row: Floats) -> None:
    """Write place and motion, given in the odometry frame, into the first four of an observation's row."""
    cos, sin = math.cos(odometry[2]), math.sin(odometry[2])
    dx, dy = x - odometry[0], y - odometry[1]
    row[0] = min(max(cos * dx + sin * dy, -FARTHEST_M), FARTHEST_M)
    row[1] = min(max(cos * dy - sin * dx, -FARTHEST_M), FARTHEST_M)
    row[2] = min(max(cos * vx + sin * vy, -FASTEST_MPS), FASTEST_MPS)
    row[3] = min(max(cos * vy - sin * vx, -FASTEST_MPS), FASTEST_MPS)


@inner_view_kernel
def people_entry(track: int, odometry: Array, known: Known, table: Floats) -> None:
    """Write who does not lead, the nearest first; `known.who` is used up."""
    table[:] = 0.0
    who, apart = known.who, known.apart
    if track >= 0:
        who[track] = False
    for row in range(len(table)):
        nearest = -1
        for i in range(len(who)):
            if who[i] and (nearest < 0 or apart[i] < apart[nearest]):
                nearest = i
        if nearest < 0:
            return
        who[nearest] = False
        place, motion = known.places[nearest], known.motions[nearest]
        _in_robot_frame(odometry, place[0], place[1], motion[0], motion[1], table[row])
        table[row, 4], table[row, 5] = known.trust[nearest], 1.0
