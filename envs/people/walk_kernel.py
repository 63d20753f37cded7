"""One tick of everybody's walk, the same for MuJoCo's worlds and for compiled ones."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...slam.view_kernel import inner_view_kernel, view_kernel
from .behaviours.deciding import go_straight
from .gait import advance_gait
from .movement.bodies import Bodies
from .movement.ground import Ways, length_of
from .movement.things import Things
from .movement.walking import advance_bodies, locate, turn_bodies, wanted_directions

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

LAP_END = 1.5
"""So far before the end of a route of several laps its start takes over [m]."""


class Walkers(NamedTuple):
    """Who n people are and what they walk on; never changes. Kernels take it as it is.

    Attributes:
        size: (n, 5) as in `gait.advance_gait`.
        radius: (n,) of the bodies [m].
        heedless: (n,) who does not see the robot.
        way: (n,) on which each walks; 0 is the route.
        first: (n,) row of `Ways.points` at which it begins.
        rows: (n,) how many it has.
    """

    size: Array
    radius: Array
    heedless: NDArray[np.bool_]
    way: Ints
    first: Ints
    rows: Ints


@view_kernel
def walk(
    dt: float,
    bodies: Bodies,
    walkers: Walkers,
    group: int,
    ways: Ways,
    things: Things,
    force: Array,
    robot: Array,
    before: Array,
) -> None:
    """Move n people for `dt` seconds, as they wish to.

    Args:
        dt: Time [s].
        bodies: Where they are; updated.
        walkers: Who they are.
        group: How many of them, the first, walk with the robot.
        ways: What they walk on.
        things: What they walk round.
        force: (9,) `SocialForceConfig.as_array()`.
        robot: (8,) as in `advance_bodies`.
        before: (n, 2) scratch.
    """
    b, own = bodies, (walkers.first, walkers.rows)
    wanted_directions(b.position, b.arc, b.sense, b.lateral, ways.points, ways.tangents, *own, b.direction)
    go_straight(b.goal, b.position, b.direction)
    advance_bodies(
        dt, b.position, b.velocity, b.heading, b.direction, b.wish, walkers.radius, walkers.heedless, robot,
        things, force, before,
    )  # fmt: skip
    _close_laps(b.arc, walkers.way, group, ways)
    locate(b.position, b.arc, ways.points, ways.tangents, *own)
    turn_bodies(dt, b.velocity, b.direction, b.wish, b.face, b.heading)
    advance_gait(
        dt, b.position, b.velocity, b.heading, walkers.size, b.feet, b.origin, b.lift, b.phase, b.swing, things
    )  # fmt: skip


@inner_view_kernel
def _close_laps(arc: Array, way: Ints, group: int, ways: Ways) -> None:
    """Carry those who do not belong to the group from the end of a route of several laps back to its start."""
    lap = ways.sizes[0]
    if lap > 0.0:
        for person in range(group, len(arc)):
            if way[person] == 0 and arc[person] > length_of(ways, 0) - LAP_END:
                arc[person] -= lap
