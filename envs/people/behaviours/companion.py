"""Somebody who keeps the leader company: walks a little ahead, and waits to fall in behind the robot when left behind.

The numbers of the mind: how far ahead of the leader [m], preferred offset from the route [m].
"""

import numpy as np
from numpy.typing import NDArray

from ....slam.view_kernel import inner_view_kernel
from ..movement.ground import heading_at
from .making_room import group_offset
from .mind import Around, CompiledWish, Mind, MindKind

_FASTEST = 1.5
_LEFT_BEHIND = 2.5  # who was overtaken by the leader stands until the robot is this far past them [m]


def companion(*, gap: float, side: float) -> Mind:
    """Return somebody who walks `gap` ahead of the leader and `side` to the left of the route [m]."""
    return Mind(MindKind.COMPANION, (gap, side))


@inner_view_kernel
def companion_wish(person: int, mind: NDArray[np.float64], around: Around) -> CompiledWish:
    """Return the leader's speed, more or less by how far the gap is from the wanted one."""
    offset, ahead = group_offset(person, mind[1], around), around.arc[person] - around.arc[0]
    if ahead < 0.0 and around.arc[person] - around.robot_arc > -_LEFT_BEHIND:
        return 0.0, offset, 1.0, around.face[person], np.nan, np.nan
    late, leader_speed = mind[0] - ahead, around.wish[0]
    waits = leader_speed == 0.0 and late < 0.2
    speed = 0.0 if waits else min(max(leader_speed + 0.8 * late, 0.0), _FASTEST)
    return speed, offset, 1.0, heading_at(around.ways, around.way[person], around.arc[person]), np.nan, np.nan
