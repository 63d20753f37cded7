"""The ways on which people walk, as compiled behaviours see them."""

import math
from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....slam.view_kernel import view_kernel
from .walking import SPACING

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]


class Ground(IntEnum):
    """Where somebody walks; the group around the robot goes by it to see who comes towards them."""

    ROUTE = 0
    """On the robot's route: comes towards the group if against its direction."""
    BESIDE = 1
    """To and fro at one place beside the route: the group makes room there whichever way this person goes."""
    ELSEWHERE = 2
    """On other ways, or freely: comes towards the group if it walks towards it."""


class Ways(NamedTuple):
    """The robot's route and, after it, the ways of bystanders; kernels take it as it is.

    Attributes:
        points: (m, 2) points of all ways, one way after the other, `SPACING` apart [m].
        tangents: (m, 2) unit vectors along them.
        free: (m, 2) how far one can walk to the left and to the right there [m].
        speed: (m,) at which somebody was recorded there [m/s]; NaN where nobody was.
        first: (p,) row at which each way begins; way 0 is the route.
        rows: (p,) how many each has.
        bends: (m,) whether the route bends nearby; of the route only.
        wide: (m,) whether two can pass there; of the route only.
        sizes: (2,) length of one lap where the route is a closed lap, else 0; clear space to both sides of it [m].
    """

    points: Array
    tangents: Array
    free: Array
    speed: Array
    first: Ints
    rows: Ints
    bends: Flags
    wide: Flags
    sizes: Array


@view_kernel
def row_at(ways: Ways, way: int, arc: float) -> int:
    """Return the row of the point of a way at `arc` [m], or of its nearest end."""
    return int(ways.first[way]) + min(max(int(arc / SPACING), 0), int(ways.rows[way]) - 1)


@view_kernel
def within_free(ways: Ways, way: int, arc: float, lateral: float) -> float:
    """Return the offset nearest to `lateral` [m] at which nothing stands beside a way at `arc` [m]."""
    row = row_at(ways, way, arc)
    return min(max(lateral, -ways.free[row, 1]), ways.free[row, 0])


@view_kernel
def heading_at(ways: Ways, way: int, arc: float) -> float:
    """Return the direction of a way at `arc` [m], in radians."""
    row = row_at(ways, way, arc)
    return math.atan2(ways.tangents[row, 1], ways.tangents[row, 0])


@view_kernel
def length_of(ways: Ways, way: int) -> float:
    """Return the length of a way [m]."""
    return (ways.rows[way] - 1) * SPACING


@view_kernel
def passing(ways: Ways) -> float:
    """Return the offset from the route at which somebody passes the group [m]."""
    return ways.sizes[1] - 0.15


@view_kernel
def turn_out(ways: Ways) -> float:
    """Return the offset from the route to which the group turns out for whom it meets [m]."""
    return min(0.35, max(0.0, ways.sizes[1] - 0.5))


@view_kernel
def narrows_before(ways: Ways, arc: float, front: float) -> bool:
    """Return whether two can pass at `arc` [m] of the route, but not on all of the next 2.5 m against its direction.

    No further than `front` [m]; two can pass where there is no bend and nothing stands on the route's left.
    """
    here = row_at(ways, 0, arc)
    low = max(row_at(ways, 0, arc - 2.5), row_at(ways, 0, front))
    return bool(ways.wide[here]) and not ways.wide[low:here].all()
