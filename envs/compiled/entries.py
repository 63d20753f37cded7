"""Entries of the observation that tell of people, as the robot of one world knows them."""

import math
from typing import Any

from ...perception.leader.selection import Company
from ...slam.view_kernel import inner_view_kernel
from ..task.observation import FARTHEST_M, FASTEST_MPS
from .state import Array, Flags, Floats


@inner_view_kernel
def leader_entry(leader: Any, odometry: Array, entry: Floats) -> None:
    """Write the `leader` (`LEADER`) in the robot's frame; zeros before one was chosen."""
    entry[:] = 0.0
    if leader.known:
        _in_robot_frame(odometry, leader.x[0], leader.x[1], leader.x[2], leader.x[3], entry)
        entry[4], entry[5] = leader.confidence, 1.0 if leader.visible else 0.0


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
def people_entry(row: int, odometry: Array, company: Company, others: Flags, table: Floats) -> None:
    """Write the `company`, the nearest first, but for its `row` that leads; `others` (n,) is room to work in."""
    table[:], others[:] = 0.0, True
    x = company.x
    if row >= 0:
        others[row] = False
    for line in range(len(table)):
        nearest, least = -1, math.inf
        for i in range(len(others)):
            if others[i]:
                away = math.hypot(x[i, 0] - odometry[0], x[i, 1] - odometry[1])
                if away < least:
                    nearest, least = i, away
        if nearest < 0:
            return
        others[nearest] = False
        _in_robot_frame(odometry, x[nearest, 0], x[nearest, 1], x[nearest, 2], x[nearest, 3], table[line])
        table[line, 4], table[line, 5] = company.confidence[nearest], 1.0
